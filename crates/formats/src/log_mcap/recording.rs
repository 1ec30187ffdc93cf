//! MCAP files as messages by topic, as far as they can be read: [`Recording`].
//!
//! A file is read record by record, and only messages of the needed topics are kept. An attachment is
//! never looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read, copy, sink};

use mcap::read::ChannelAccumulator;
use mcap::records::{Record, op};

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::records::{
    Stop, damage, damaged, parse, records, split_record, unpacked, unreadable,
};
use crate::log_mcap::topics::Topics;

/// Largest size of a message of a needed topic (bytes); poses, forces and touches take 200.
const MESSAGE_LIMIT: usize = 1 << 16;

/// How what zstd packed begins; plain CDR and MCAP begin otherwise.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// A message as it is recorded.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RawMessage {
    /// Which file it is in, from 0.
    pub file: usize,
    /// Number among those of its topic in the file, from 1.
    pub number: usize,
    /// Log time (ns).
    pub log_time: u64,
    /// What it says.
    pub data: Vec<u8>,
}

/// Where a file ends before its end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Damage {
    /// Which file, from 0.
    pub file: usize,
    /// Bytes that were read.
    pub at: u64,
    /// Bytes of the file.
    pub size: u64,
    /// What follows them.
    pub why: String,
}

/// Type and encoding of the messages of a channel.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Kind {
    /// Message type.
    pub schema: String,
    /// Message encoding.
    pub encoding: String,
}

/// What a topic holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Content {
    /// Types and encodings of its channels.
    pub kinds: BTreeSet<Kind>,
    /// Its messages in the order of the file.
    pub messages: Vec<RawMessage>,
}

/// Which topics are read.
pub(crate) trait Wanted {
    /// Whether a topic with messages of a type is read.
    fn wants(&self, name: &str, schema: &str) -> bool;
}

impl Wanted for Topics {
    fn wants(&self, name: &str, _: &str) -> bool {
        self.wants(name)
    }
}

/// What was seen of a topic, read or not.
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
    /// Where its files were cut off.
    pub damage: Vec<Damage>,
    /// How many files were read.
    files: usize,
}

/// A file while it is read.
struct Progress<'t> {
    wanted: &'t dyn Wanted,
    links: ChannelAccumulator<'static>,
    recording: &'t mut Recording,
    /// Messages so far by topic.
    numbers: BTreeMap<String, usize>,
}

impl Recording {
    /// Adds what a file holds of the topics that `wanted` names, up to the first damage. The whole
    /// file may be packed with zstd.
    pub(crate) fn add(&mut self, file: impl Read, wanted: &dyn Wanted) -> Result<(), McapProblem> {
        let mut start = Vec::new();
        let mut file = file;
        let read = (&mut file)
            .take(mcap::MAGIC.len() as u64)
            .read_to_end(&mut start);
        read.map_err(|error| unreadable(&error))?;
        let packed = start.starts_with(&ZSTD);
        let whole = start.as_slice().chain(file);
        if !packed {
            return self.add_unpacked(whole, wanted);
        }
        let unpacked = zstd::stream::read::Decoder::new(whole);
        self.add_unpacked(unpacked.map_err(|error| unreadable(&error))?, wanted)
    }

    fn add_unpacked(&mut self, file: impl Read, wanted: &dyn Wanted) -> Result<(), McapProblem> {
        let mut file = Counted { file, bytes: 0 };
        let number = self.files;
        self.files += 1;
        let mut magic = Vec::new();
        let start = (&mut file)
            .take(mcap::MAGIC.len() as u64)
            .read_to_end(&mut magic);
        let why = match start {
            Ok(_) if magic == mcap::MAGIC => None,
            // what a killed recorder began, behind files that are whole
            Ok(_) if number > 0 && mcap::MAGIC.starts_with(&magic) => {
                Some("it ends at once".to_owned())
            }
            Ok(_) => {
                let hex = magic.iter().map(|byte| format!("{byte:02X}"));
                let found = hex.collect::<Vec<_>>().join(" ");
                return Err(McapProblem::NotMcap { found });
            }
            Err(error) => match damaged(&error) {
                Stop::Damage(why) => Some(why),
                Stop::Refused(problem) => return Err(problem),
            },
        };
        if let Some(why) = why {
            self.damage.push(Damage {
                file: number,
                at: 0,
                size: file.bytes,
                why,
            });
            return Ok(());
        }
        let mut progress = Progress {
            wanted,
            links: ChannelAccumulator::default(),
            recording: self,
            numbers: BTreeMap::new(),
        };
        let mut at = mcap::MAGIC.len() as u64;
        let mut in_summary = false;
        let read = records(&mut file, &mut |opcode, body| {
            // the summary repeats what came before it
            in_summary |= opcode == op::DATA_END;
            match opcode {
                _ if in_summary => {}
                op::CHUNK => progress.take_chunk(body)?,
                _ => progress.take(opcode, body)?,
            }
            at += 9 + body.len() as u64;
            Ok(())
        });
        match read {
            Ok(()) => Ok(()),
            Err(Stop::Damage(why)) => {
                // how much is lost; what cannot be read any more is not counted
                let _ = copy(&mut file, &mut sink());
                let size = file.bytes;
                self.damage.push(Damage {
                    file: number,
                    at,
                    size,
                    why,
                });
                Ok(())
            }
            Err(Stop::Refused(problem)) => Err(problem),
        }
    }
}

/// A file and how much of it was read.
struct Counted<R> {
    file: R,
    bytes: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.bytes += read as u64;
        Ok(read)
    }
}

impl Progress<'_> {
    fn take_chunk(&mut self, body: &[u8]) -> Result<(), Stop> {
        let (header, packed) = match parse(op::CHUNK, body)? {
            Record::Chunk { header, data } => (header, data),
            _ => return Err(damage("a chunk is none")),
        };
        let content = unpacked(&header, &packed)?;
        let mut rest = content.as_slice();
        while !rest.is_empty() {
            let (opcode, body, after) =
                split_record(rest).ok_or_else(|| damage("a record is longer than its chunk"))?;
            self.take(opcode, body)?;
            rest = after;
        }
        Ok(())
    }

    fn take(&mut self, opcode: u8, body: &[u8]) -> Result<(), Stop> {
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        match parse(opcode, body)? {
            Record::Schema { header, data } => self.links.add_schema_from_slice(header, &data)?,
            Record::Channel(channel) => {
                let id = channel.id;
                self.links.add_channel(channel)?;
                self.take_channel(id)?;
            }
            Record::Message { header, data } => {
                let channel = self
                    .links
                    .get(header.channel_id)
                    .ok_or_else(|| damage("a message is of no channel"))?;
                if let Some(seen) = self.recording.names.get_mut(&channel.topic) {
                    seen.add(header.log_time);
                }
                let Some(content) = self.recording.topics.get_mut(&channel.topic) else {
                    return Ok(());
                };
                let data = message_data(&channel.topic, &data)?;
                let number = self.numbers.entry(channel.topic.clone()).or_default();
                *number += 1;
                content.messages.push(RawMessage {
                    file: self.recording.files - 1,
                    number: *number,
                    log_time: header.log_time,
                    data,
                });
            }
            _ => {}
        }
        Ok(())
    }

    fn take_channel(&mut self, id: u16) -> Result<(), Stop> {
        let channel = self
            .links
            .get(id)
            .ok_or_else(|| damage("a channel is lost"))?;
        let schema = channel
            .schema
            .as_ref()
            .map_or(String::new(), |schema| schema.name.clone());
        let seen = self.recording.names.entry(channel.topic.clone());
        seen.or_default().schema.clone_from(&schema);
        if self.wanted.wants(&channel.topic, &schema) {
            let kind = Kind {
                schema,
                encoding: channel.message_encoding.clone(),
            };
            let content = self.recording.topics.entry(channel.topic.clone());
            content.or_default().kinds.insert(kind);
        }
        Ok(())
    }
}

/// What a message of a needed topic says; it may be packed with zstd by itself.
fn message_data(topic: &str, data: &[u8]) -> Result<Vec<u8>, Stop> {
    let too_large = |size| {
        Stop::Refused(McapProblem::LargeMessage {
            topic: topic.to_owned(),
            size,
            limit: MESSAGE_LIMIT,
        })
    };
    if data.len() > MESSAGE_LIMIT {
        return Err(too_large(data.len()));
    }
    if !data.starts_with(&ZSTD) {
        return Ok(data.to_vec());
    }
    let mut unpacked = Vec::new();
    let read = zstd::stream::read::Decoder::new(data).and_then(|packed| {
        packed
            .take(MESSAGE_LIMIT as u64 + 1)
            .read_to_end(&mut unpacked)
    });
    match read {
        Ok(size) if size > MESSAGE_LIMIT => Err(too_large(size)),
        Ok(_) => Ok(unpacked),
        Err(error) => Err(Stop::Damage(format!(
            "a message cannot be unpacked: {error}"
        ))),
    }
}
