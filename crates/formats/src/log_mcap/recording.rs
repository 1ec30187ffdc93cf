//! The messages of MCAP files by topic, as far as they can be read: [`Recording`].
//!
//! Only messages of the needed topics are kept.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::messages::{Damage, Kind, Recorded, Visitor, message_data, messages};
use crate::log_mcap::records::Stop;

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

    /// Returns true if a message of such a topic at a log time (ns) is read.
    fn takes(&self, name: &str, log_time: u64) -> bool {
        let _ = (name, log_time);
        true
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
    /// Bytes of the files before the current one, and of that so far.
    read: [u64; 2],
    /// Number of messages that are kept.
    kept: usize,
    /// Memory that they take (bytes).
    memory: usize,
}

/// Memory that messages may take, whatever the size of their recording (bytes).
const MEMORY: usize = 24 << 20;
/// Memory that they may take for each byte of it.
const MEMORY_RATIO: usize = 16;
/// Memory of a message besides its bytes.
const OVERHEAD: usize = size_of::<RawMessage>() + 24;

impl Recording {
    /// Counts a message that is kept.
    fn keep(&mut self, bytes: usize, read: u64) -> Result<(), Stop> {
        self.kept += 1;
        self.read[1] = read;
        self.memory += bytes + OVERHEAD;
        let [before, read] = self.read;
        let of_files = usize::try_from(before.saturating_add(read)).unwrap_or(usize::MAX);
        if self.memory > MEMORY.saturating_add(MEMORY_RATIO.saturating_mul(of_files)) {
            return Err(Stop::Refused(McapProblem::Memory {
                count: self.kept,
                megabytes: self.memory / 1_000_000,
            }));
        }
        Ok(())
    }
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
        self.read = [self.read[0].saturating_add(self.read[1]), 0];
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
            read,
        } = message;
        if let Some(seen) = self.recording.names.get_mut(topic) {
            seen.add(log_time);
        }
        let is_kept = self.recording.topics.contains_key(topic);
        if !is_kept || !self.wanted.takes(topic, log_time) {
            return Ok(());
        }
        let data: Box<[u8]> = message_data(topic, data, MESSAGE_LIMIT)?.into();
        self.recording.keep(data.len(), read)?;
        let Some(content) = self.recording.topics.get_mut(topic) else {
            return Ok(());
        };
        let number = match self.numbers.get_mut(topic) {
            Some(number) => number,
            None => self.numbers.entry(topic.to_owned()).or_default(),
        };
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
