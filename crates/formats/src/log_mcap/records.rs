//! An MCAP file as records, as far as it can be read: [`records`], and the content of a chunk.
//!
//! Whole chunks are unpacked here and not by the library's reader: that one trusts the lengths in
//! them.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write, copy};

use mcap::read::parse_record;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::log_mcap::error::McapProblem;

/// Largest size of a record and of an unpacked chunk (bytes); recorders write a few MB, a large
/// image takes 50. A record that is not packed is in memory as a whole.
pub(crate) const CHUNK_LIMIT: u64 = 1 << 28;

/// Most bytes that are taken from a file at once: a record may claim more than there is.
const LARGEST_READ: usize = 1 << 20;

/// Reason why reading stopped.
pub(crate) enum Stop {
    /// The file is damaged here.
    Damage(String),
    /// It cannot be read.
    Refused(McapProblem),
    /// The visitor has seen enough.
    Enough,
}

impl From<mcap::McapError> for Stop {
    fn from(error: mcap::McapError) -> Self {
        Self::Damage(error.to_string())
    }
}

/// Reason why a file cannot be read at all.
pub(crate) fn unreadable(error: &io::Error) -> McapProblem {
    McapProblem::Unreadable {
        why: error.to_string(),
    }
}

/// Reason why a file cannot be read on: its decoder reports that by the first two kinds.
pub(crate) fn damaged(error: &io::Error) -> Stop {
    match error.kind() {
        ErrorKind::FileTooLarge => Stop::Refused(McapProblem::Unpacks),
        ErrorKind::UnexpectedEof | ErrorKind::Other => Stop::Damage(error.to_string()),
        _ => Stop::Refused(unreadable(error)),
    }
}

/// Bytes that a recording may unpack to, whatever its own size.
const UNPACKED: u64 = 1 << 29;
/// Bytes that it may unpack to for each byte of its own.
const RATIO: u64 = 100;

/// Refuses content of `unpacked` bytes in `packed` bytes of a file: a recording is not so uniform.
pub(crate) fn check_unpacked(unpacked: u64, packed: u64) -> io::Result<()> {
    match unpacked > UNPACKED.saturating_add(RATIO.saturating_mul(packed)) {
        true => Err(ErrorKind::FileTooLarge.into()),
        false => Ok(()),
    }
}

/// A file that ends here, for this reason.
pub(crate) fn damage(why: &str) -> Stop {
    Stop::Damage(why.to_owned())
}

/// Takes a record: opcode and body.
type Take<'t> = dyn FnMut(u8, &[u8]) -> Result<(), Stop> + 't;

/// Shows all records of a file behind its first bytes to `take`, one at a time.
pub(crate) fn records(file: &mut dyn Read, take: &mut Take<'_>) -> Result<(), Stop> {
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

/// A record whose texts lie within it; the library reserves memory by their lengths before it
/// checks them.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, Stop> {
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

/// Bytes that follow `count` texts, each behind its length.
fn after_texts(bytes: &[u8], count: usize) -> Option<&[u8]> {
    (0..count).try_fold(bytes, |rest, _| {
        let (length, rest) = rest.split_first_chunk()?;
        rest.get(u32::from_le_bytes(*length) as usize..)
    })
}

/// `Some` if all keys and values of a map lie in it.
fn map_fits(bytes: &[u8]) -> Option<()> {
    let (length, rest) = bytes.split_first_chunk()?;
    let mut map = rest.get(..u32::from_le_bytes(*length) as usize)?;
    while !map.is_empty() {
        map = after_texts(map, 2)?;
    }
    Some(())
}

/// Shows the records in a chunk to `take`, one at a time; their checksum is right. Content that is
/// larger than [`HELD`] is unpacked twice: for the checksum, and record by record.
pub(crate) fn chunk_records(
    header: &ChunkHeader,
    packed: &[u8],
    take: &mut Take<'_>,
) -> Result<(), Stop> {
    let size = header.uncompressed_size;
    if size > CHUNK_LIMIT {
        return Err(Stop::Damage(format!(
            "a chunk claims {size} bytes, more than {CHUNK_LIMIT}"
        )));
    }
    if size > HELD && !header.compression.is_empty() {
        let mut sum = Checksum::default();
        copy(&mut unpacked(header, packed)?.take(size + 1), &mut sum).map_err(failed)?;
        sum.check(header)?;
        return split_records(&mut BufReader::new(unpacked(header, packed)?), take);
    }
    let mut content = Vec::new();
    let read = unpacked(header, packed)?
        .take(size + 1)
        .read_to_end(&mut content);
    read.map_err(failed)?;
    let mut sum = Checksum::default();
    sum.write_all(&content).map_err(failed)?;
    sum.check(header)?;
    split_records(&mut content.as_slice(), take)
}

/// Largest content of a chunk that is unpacked as a whole (bytes).
const HELD: u64 = 1 << 24;

fn failed(error: io::Error) -> Stop {
    Stop::Damage(format!("a chunk cannot be unpacked: {error}"))
}

/// Content of a chunk.
fn unpacked<'p>(header: &ChunkHeader, packed: &'p [u8]) -> Result<Box<dyn Read + 'p>, Stop> {
    Ok(match header.compression.as_str() {
        "" => Box::new(packed),
        "zstd" => Box::new(zstd::stream::read::Decoder::new(packed).map_err(failed)?),
        "lz4" => Box::new(lz4::Decoder::new(packed).map_err(failed)?),
        found => {
            return Err(Stop::Refused(McapProblem::Compression {
                found: found.to_owned(),
            }));
        }
    })
}

/// Size and checksum of the content of a chunk.
#[derive(Default)]
struct Checksum {
    size: u64,
    crc: crc32fast::Hasher,
}

impl Write for Checksum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.size += bytes.len() as u64;
        self.crc.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Checksum {
    fn check(self, header: &ChunkHeader) -> Result<(), Stop> {
        let size = header.uncompressed_size;
        if self.size != size {
            let more = if self.size > size { "more than " } else { "" };
            let found = self.size.min(size);
            return Err(Stop::Damage(format!(
                "a chunk has {more}{found} bytes, and its header says {size}"
            )));
        }
        match header.uncompressed_crc {
            0 => Ok(()),
            crc if crc == self.crc.finalize() => Ok(()),
            _ => Err(damage("a chunk's checksum is wrong")),
        }
    }
}

/// Takes the content of a chunk apart.
fn split_records(content: &mut dyn BufRead, take: &mut Take<'_>) -> Result<(), Stop> {
    let too_long = |_: io::Error| damage("a record is longer than its chunk");
    let mut body = Vec::new();
    while !content.fill_buf().map_err(failed)?.is_empty() {
        let (mut opcode, mut length) = ([0], [0; 8]);
        content.read_exact(&mut opcode).map_err(too_long)?;
        content.read_exact(&mut length).map_err(too_long)?;
        let length = u64::from_le_bytes(length);
        body.clear();
        let read = (&mut *content).take(length).read_to_end(&mut body);
        if read.map_err(failed)? as u64 != length {
            return Err(damage("a record is longer than its chunk"));
        }
        take(opcode[0], &body)?;
    }
    Ok(())
}
