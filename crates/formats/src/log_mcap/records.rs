//! An MCAP file as records, as far as it can be read: [`records`], and the content of a chunk.
//!
//! Whole chunks are unpacked here and not by the library's reader: that one trusts the lengths in
//! them.

use std::io::{self, ErrorKind, Read};

use mcap::read::parse_record;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::log_mcap::error::McapProblem;

/// Largest size of a record and of an unpacked chunk (bytes); recorders write a few MB, a large
/// image takes 50. No more than this of a file is in memory at a time.
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

/// Reason why a file cannot be read on: its decoder reports that by these two kinds.
pub(crate) fn damaged(error: &io::Error) -> Stop {
    match error.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::Other => Stop::Damage(error.to_string()),
        _ => Stop::Refused(unreadable(error)),
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

/// The first record of a chunk's content: its opcode, its body and the bytes that follow.
pub(crate) fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (body, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*opcode, body, rest))
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

/// The records in a chunk; their checksum is right.
pub(crate) fn unpacked(header: &ChunkHeader, packed: &[u8]) -> Result<Vec<u8>, Stop> {
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
