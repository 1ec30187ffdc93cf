//! An MCAP file as messages, as far as it can be read: [`messages`].
//!
//! A file is read record by record, and no more than one chunk of it is in memory. Attachments are
//! skipped.

use std::borrow::Cow;
use std::cell::Cell;
use std::io::{self, Read, copy, sink};

use mcap::read::ChannelAccumulator;
use mcap::records::{Record, op};

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::records::{
    CHUNK_LIMIT, Stop, check_unpacked, chunk_records, damage, damaged, parse, records, unreadable,
};

/// First bytes of data packed with zstd; plain CDR and MCAP begin otherwise.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Place at which a file ends before its end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Damage {
    /// Number of the file, from 0.
    pub file: usize,
    /// Bytes that were read.
    pub at: u64,
    /// Bytes of the file.
    pub size: u64,
    /// Reason why the rest cannot be read.
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

/// A message as it lies in its file; it may be packed by itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recorded<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// Log time (ns).
    pub log_time: u64,
    /// Its bytes.
    pub data: &'a [u8],
    /// Bytes of its file that were read so far.
    pub read: u64,
}

/// Visitor of the channels and messages of a file.
pub(crate) trait Visitor {
    /// Takes a channel, before its messages, perhaps several times.
    fn channel(&mut self, topic: &str, kind: Kind) -> Result<(), Stop>;

    /// A message, in the order of the file.
    fn message(&mut self, message: Recorded<'_>) -> Result<(), Stop>;
}

/// Shows all messages of file number `number` of a bag to `visitor`, up to the first damage, which
/// is returned. The whole file may be packed with zstd.
pub(crate) fn messages(
    file: impl Read,
    number: usize,
    visitor: &mut dyn Visitor,
) -> Result<Option<Damage>, McapProblem> {
    let mut start = Vec::new();
    let packed_bytes = Cell::new(0);
    let mut file = Metered {
        file,
        bytes: &packed_bytes,
    };
    let read = (&mut file)
        .take(mcap::MAGIC.len() as u64)
        .read_to_end(&mut start);
    read.map_err(|error| unreadable(&error))?;
    let packed = start.starts_with(&ZSTD);
    let mut whole = start.as_slice().chain(file);
    if !packed {
        return unpacked_messages(&mut whole, (number, &packed_bytes), visitor);
    }
    let unpacked = zstd::stream::read::Decoder::new(whole);
    let mut unpacked = Unpacking {
        file: unpacked.map_err(|error| unreadable(&error))?,
        bytes: 0,
        packed: &packed_bytes,
    };
    unpacked_messages(&mut unpacked, (number, &packed_bytes), visitor)
}

/// A file, and the bytes that were read of it.
struct Metered<'m, R> {
    file: R,
    bytes: &'m Cell<u64>,
}

impl<R: Read> Read for Metered<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.bytes.set(self.bytes.get() + read as u64);
        Ok(read)
    }
}

/// Content of a packed file, which ends with an error where it is far too large.
struct Unpacking<'m, R> {
    file: R,
    bytes: u64,
    packed: &'m Cell<u64>,
}

impl<R: Read> Read for Unpacking<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.bytes += read as u64;
        check_unpacked(self.bytes, self.packed.get())?;
        Ok(read)
    }
}

fn unpacked_messages(
    file: &mut dyn Read,
    (number, read): (usize, &Cell<u64>),
    visitor: &mut dyn Visitor,
) -> Result<Option<Damage>, McapProblem> {
    let mut file = Counted { file, bytes: 0 };
    if let Some(why) = file.no_magic(number)? {
        return Ok(Some(Damage {
            file: number,
            at: 0,
            size: file.bytes,
            why,
        }));
    }
    let mut progress = Progress {
        visitor,
        links: ChannelAccumulator::default(),
        read,
        unpacked: 0,
    };
    let mut at = mcap::MAGIC.len() as u64;
    let mut in_summary = false;
    let read = records(&mut file, &mut |opcode, body| {
        // the summary repeats what came before it
        in_summary |= opcode == op::DATA_END;
        match opcode {
            0 => return Err(damage("a record is of no kind")),
            _ if in_summary => {}
            op::CHUNK => progress.take_chunk(body)?,
            _ => progress.take(opcode, body)?,
        }
        at += 9 + body.len() as u64;
        Ok(())
    });
    match read {
        Ok(()) | Err(Stop::Enough) => Ok(None),
        Err(Stop::Damage(why)) => {
            // how much is lost; what cannot be read any more is not counted
            if let Err(Stop::Refused(McapProblem::Unpacks)) =
                copy(&mut file, &mut sink()).map_err(|error| damaged(&error))
            {
                return Err(McapProblem::Unpacks);
            }
            Ok(Some(Damage {
                file: number,
                at,
                size: file.bytes,
                why,
            }))
        }
        Err(Stop::Refused(problem)) => Err(problem),
    }
}

/// A file and how much of it was read.
struct Counted<'f> {
    file: &'f mut dyn Read,
    bytes: u64,
}

impl Counted<'_> {
    /// Reads the first bytes of an MCAP file; why there are none, if it was cut off at once.
    fn no_magic(&mut self, number: usize) -> Result<Option<String>, McapProblem> {
        let mut magic = Vec::new();
        let start = self.take(mcap::MAGIC.len() as u64).read_to_end(&mut magic);
        match start {
            Ok(_) if magic == mcap::MAGIC => Ok(None),
            // what a killed recorder began, behind files that are whole
            Ok(_) if number > 0 && mcap::MAGIC.starts_with(&magic) => {
                Ok(Some("it ends at once".to_owned()))
            }
            Ok(_) => {
                let hex = magic.iter().map(|byte| format!("{byte:02X}"));
                let found = hex.collect::<Vec<_>>().join(" ");
                Err(McapProblem::NotMcap { found })
            }
            Err(error) => match damaged(&error) {
                Stop::Damage(why) => Ok(Some(why)),
                Stop::Refused(problem) => Err(problem),
                Stop::Enough => Ok(None),
            },
        }
    }
}

impl Read for Counted<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.bytes += read as u64;
        Ok(read)
    }
}

/// A file while it is read.
struct Progress<'t> {
    visitor: &'t mut dyn Visitor,
    links: ChannelAccumulator<'static>,
    /// Bytes of the file that were read.
    read: &'t Cell<u64>,
    /// Bytes that its chunks unpacked to.
    unpacked: u64,
}

impl Progress<'_> {
    fn take_chunk(&mut self, body: &[u8]) -> Result<(), Stop> {
        let (header, packed) = match parse(op::CHUNK, body)? {
            Record::Chunk { header, data } => (header, data),
            _ => return Err(damage("a chunk is none")),
        };
        self.unpacked = self
            .unpacked
            .saturating_add(header.uncompressed_size.min(CHUNK_LIMIT));
        check_unpacked(self.unpacked, self.read.get()).map_err(|error| damaged(&error))?;
        chunk_records(&header, &packed, &mut |opcode, body| {
            self.take(opcode, body)
        })
    }

    fn take(&mut self, opcode: u8, body: &[u8]) -> Result<(), Stop> {
        if opcode == 0 {
            return Err(damage("a record is of no kind"));
        }
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
                self.visitor.message(Recorded {
                    topic: &channel.topic,
                    log_time: header.log_time,
                    data: &data,
                    read: self.read.get(),
                })?;
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
        let schema = channel.schema.as_ref();
        let kind = Kind {
            schema: schema.map_or(String::new(), |schema| schema.name.clone()),
            encoding: channel.message_encoding.clone(),
        };
        self.visitor.channel(&channel.topic, kind)
    }
}

/// Bytes of a message of a needed topic, at most `limit` of them; it may be packed with zstd by
/// itself.
pub(crate) fn message_data<'d>(
    topic: &str,
    data: &'d [u8],
    limit: usize,
) -> Result<Cow<'d, [u8]>, Stop> {
    let too_large = |size| {
        Stop::Refused(McapProblem::LargeMessage {
            topic: topic.to_owned(),
            size,
            limit,
        })
    };
    if data.len() > limit {
        return Err(too_large(data.len()));
    }
    if !data.starts_with(&ZSTD) {
        return Ok(Cow::Borrowed(data));
    }
    let mut unpacked = Vec::new();
    let read = zstd::stream::read::Decoder::new(data)
        .and_then(|packed| packed.take(limit as u64 + 1).read_to_end(&mut unpacked));
    match read {
        Ok(size) if size > limit => Err(too_large(size)),
        Ok(_) => Ok(Cow::Owned(unpacked)),
        Err(error) => Err(Stop::Damage(format!(
            "a message cannot be unpacked: {error}"
        ))),
    }
}
