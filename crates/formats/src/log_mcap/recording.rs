//! MCAP files as messages by topic, as far as they can be read: [`Recording`].
//!
//! A file is read record by record, and only messages of the needed topics are kept. Whole chunks are
//! unpacked here and not by the library's reader: that one trusts the lengths in them. An attachment is
//! never looked at.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind, Read, copy, sink};

use mcap::read::{ChannelAccumulator, parse_record};
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::topics::Topics;

/// Largest size of a record and of an unpacked chunk (bytes); recorders write a few MB, a large image
/// takes 50. No more than this of a file is in memory at a time.
const CHUNK_LIMIT: u64 = 1 << 28;

/// Largest size of a message of a needed topic (bytes); poses, forces and touches take 200.
const MESSAGE_LIMIT: usize = 1 << 16;

/// How what zstd packed begins; plain CDR and MCAP begin otherwise.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Most bytes that are taken from a file at once: a record may claim more than there is.
const LARGEST_READ: usize = 1 << 20;

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

/// The topics of a recording that a log needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recording {
    /// Names of all topics.
    pub names: BTreeSet<String>,
    /// The needed ones by name.
    pub topics: BTreeMap<String, Content>,
    /// Where its files were cut off.
    pub damage: Vec<Damage>,
    /// How many files were read.
    files: usize,
}

/// Why reading stopped.
enum Stop {
    Damage(String),
    Refused(McapProblem),
}

impl From<mcap::McapError> for Stop {
    fn from(error: mcap::McapError) -> Self {
        Self::Damage(error.to_string())
    }
}

/// A file while it is read.
struct Progress<'t> {
    wanted: &'t Topics,
    links: ChannelAccumulator<'static>,
    recording: &'t mut Recording,
    /// Messages so far by topic.
    numbers: BTreeMap<String, usize>,
}

impl Recording {
    /// Adds what a file holds of the topics that `wanted` names, up to the first damage. The whole
    /// file may be packed with zstd.
    pub(crate) fn add(&mut self, file: impl Read, wanted: &Topics) -> Result<(), McapProblem> {
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

    fn add_unpacked(&mut self, file: impl Read, wanted: &Topics) -> Result<(), McapProblem> {
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

fn unreadable(error: &io::Error) -> McapProblem {
    McapProblem::Unreadable {
        why: error.to_string(),
    }
}

/// Why a file cannot be read on: what unpacks it says so by these two kinds.
fn damaged(error: &io::Error) -> Stop {
    match error.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::Other => Stop::Damage(error.to_string()),
        _ => Stop::Refused(unreadable(error)),
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
        self.recording.names.insert(channel.topic.clone());
        if self.wanted.wants(&channel.topic) {
            let schema = channel
                .schema
                .as_ref()
                .map_or(String::new(), |schema| schema.name.clone());
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

fn damage(why: &str) -> Stop {
    Stop::Damage(why.to_owned())
}

/// Takes a record: opcode and body.
type Take<'t> = dyn FnMut(u8, &[u8]) -> Result<(), Stop> + 't;

/// Shows all records of a file behind its first bytes to `take`, one at a time.
fn records(file: &mut dyn Read, take: &mut Take<'_>) -> Result<(), Stop> {
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_skip_start_magic(true)
        .with_record_length_limit(CHUNK_LIMIT as usize);
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let read = file.read(reader.insert(need.min(LARGEST_READ)));
                let read = read.map_err(|error| damaged(&error))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
        }
    }
    Ok(())
}

/// The first record of a chunk's content: its opcode, its body and what follows.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (body, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*opcode, body, rest))
}

/// A record whose texts lie within it; the library reserves memory by their lengths before it
/// looks.
fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, Stop> {
    let fits = match opcode {
        op::SCHEMA => body
            .get(2..)
            .and_then(|rest| after_texts(rest, 2))
            .is_some(),
        op::CHANNEL => body
            .get(4..)
            .and_then(|rest| after_texts(rest, 2))
            .and_then(map_fits)
            .is_some(),
        op::CHUNK => body
            .get(28..)
            .and_then(|rest| after_texts(rest, 1))
            .is_some(),
        _ => true,
    };
    if fits {
        Ok(parse_record(opcode, body)?)
    } else {
        Err(damage("a text is longer than its record"))
    }
}

/// What follows `count` texts, each behind its length.
fn after_texts(bytes: &[u8], count: usize) -> Option<&[u8]> {
    (0..count).try_fold(bytes, |rest, _| {
        let (length, rest) = rest.split_first_chunk()?;
        rest.get(u32::from_le_bytes(*length) as usize..)
    })
}

/// Whether all keys and values of a map lie in it.
fn map_fits(bytes: &[u8]) -> Option<()> {
    let (length, rest) = bytes.split_first_chunk()?;
    let mut map = rest.get(..u32::from_le_bytes(*length) as usize)?;
    while !map.is_empty() {
        map = after_texts(map, 2)?;
    }
    Some(())
}

/// The records in a chunk; their checksum is right.
fn unpacked(header: &ChunkHeader, packed: &[u8]) -> Result<Vec<u8>, Stop> {
    let size = header.uncompressed_size;
    if size > CHUNK_LIMIT {
        return Err(Stop::Damage(format!(
            "a chunk claims {size} bytes, more than {CHUNK_LIMIT}"
        )));
    }
    let failed =
        |error: std::io::Error| Stop::Damage(format!("a chunk cannot be unpacked: {error}"));
    let mut content = Vec::new();
    let read = match header.compression.as_str() {
        "" => packed.take(size).read_to_end(&mut content),
        "zstd" => zstd::stream::read::Decoder::new(packed)
            .map_err(failed)?
            .take(size)
            .read_to_end(&mut content),
        "lz4" => lz4::Decoder::new(packed)
            .map_err(failed)?
            .take(size)
            .read_to_end(&mut content),
        found => {
            return Err(Stop::Refused(McapProblem::Compression {
                found: found.to_owned(),
            }));
        }
    };
    read.map_err(failed)?;
    if content.len() as u64 != size {
        return Err(Stop::Damage(format!(
            "a chunk has {} bytes, and its header says {size}",
            content.len()
        )));
    }
    match header.uncompressed_crc {
        0 => Ok(content),
        crc if crc == crc32fast::hash(&content) => Ok(content),
        _ => Err(damage("a chunk's checksum is wrong")),
    }
}
