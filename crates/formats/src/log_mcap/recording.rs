//! The messages of MCAP files by topic, as far as they can be read: [`Recording`].
//!
//! Only messages of the needed topics are kept.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::messages::{Damage, Kind, Recorded, Visitor, message_data, messages};
use crate::log_mcap::records::Stop;
use crate::log_mcap::topics::Topics;

/// Largest size of a message of a needed topic (bytes); poses, forces and touches take 200.
const MESSAGE_LIMIT: usize = 1 << 16;

/// A message as it is recorded.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RawMessage {
    /// Number of its file, from 0.
    pub file: u32,
    /// Number among those of its topic in the file, from 1.
    pub number: u32,
    /// Log time (ns).
    pub log_time: u64,
    /// Its bytes.
    pub data: Box<[u8]>,
}

/// Content of a topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct Content {
    /// Types and encodings of its channels.
    pub kinds: BTreeSet<Kind>,
    /// Its messages in the order of the file.
    pub messages: Vec<RawMessage>,
}

/// Choice of the topics that are read.
pub(crate) trait Wanted {
    /// Returns true if a topic with messages of a type is read.
    fn wants(&self, name: &str, schema: &str) -> bool;
}

impl Wanted for Topics {
    fn wants(&self, name: &str, _: &str) -> bool {
        self.wants(name)
    }
}

/// Counts of a topic, read or not.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// Message type.
    pub schema: String,
    /// Number of messages.
    pub count: usize,
    /// Log time of the first message (ns).
    pub first: u64,
    /// Latest log time (ns).
    pub last: u64,
    /// Longest log time from one message to the next in the file (ns).
    pub longest_gap: u64,
    /// Log time of the message before (ns).
    before: u64,
}

impl Seen {
    /// Counts a message.
    fn add(&mut self, log_time: u64) {
        if self.count == 0 {
            (self.first, self.last, self.before) = (log_time, log_time, log_time);
        }
        self.count += 1;
        self.longest_gap = self.longest_gap.max(log_time.abs_diff(self.before));
        self.before = log_time;
        self.first = self.first.min(log_time);
        self.last = self.last.max(log_time);
    }
}

/// The topics of a recording that a log needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recording {
    /// All topics by name.
    pub names: BTreeMap<String, Seen>,
    /// The needed ones by name.
    pub topics: BTreeMap<String, Content>,
    /// Places at which its files were cut off.
    pub damage: Vec<Damage>,
    /// Number of files that were read.
    files: usize,
}

/// Keeps the messages of a file.
pub(crate) struct Keeper<'t> {
    wanted: &'t dyn Wanted,
    recording: &'t mut Recording,
    /// Number of the file, from 0.
    file: usize,
    /// Messages so far by topic.
    numbers: BTreeMap<String, u32>,
}

impl Recording {
    /// Adds a file's messages of the topics that `wanted` names, up to the first damage. The whole
    /// file may be packed with zstd.
    pub(crate) fn add(&mut self, file: impl Read, wanted: &dyn Wanted) -> Result<(), McapProblem> {
        let mut keeper = self.keeper(wanted);
        let number = keeper.file;
        let damage = messages(file, number, &mut keeper)?;
        self.damage.extend(damage);
        Ok(())
    }

    /// Visitor that keeps the messages of one more file.
    pub(crate) fn keeper<'t>(&'t mut self, wanted: &'t dyn Wanted) -> Keeper<'t> {
        self.files += 1;
        Keeper {
            wanted,
            file: self.files - 1,
            recording: self,
            numbers: BTreeMap::new(),
        }
    }
}

impl Visitor for Keeper<'_> {
    fn channel(&mut self, topic: &str, kind: Kind) -> Result<(), Stop> {
        let seen = self.recording.names.entry(topic.to_owned());
        seen.or_default().schema.clone_from(&kind.schema);
        if self.wanted.wants(topic, &kind.schema) {
            let content = self.recording.topics.entry(topic.to_owned());
            content.or_default().kinds.insert(kind);
        }
        Ok(())
    }

    fn message(&mut self, message: Recorded<'_>) -> Result<(), Stop> {
        let Recorded {
            topic,
            log_time,
            data,
        } = message;
        if let Some(seen) = self.recording.names.get_mut(topic) {
            seen.add(log_time);
        }
        let Some(content) = self.recording.topics.get_mut(topic) else {
            return Ok(());
        };
        let data = message_data(topic, data, MESSAGE_LIMIT)?.into();
        let number = self.numbers.entry(topic.to_owned()).or_default();
        *number += 1;
        content.messages.push(RawMessage {
            file: self.file as u32,
            number: *number,
            log_time,
            data,
        });
        Ok(())
    }
}
