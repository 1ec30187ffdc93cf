//! The one place where the program speaks: results by [`show`] on standard output, all else by
//! [`talk`] on standard error.
//!
//! A reader may leave early, as `head` does. That is no failure: the remaining output is dropped,
//! files are still written, and the exit code is that of the work.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use anyhow::Result;
use serde::Serialize;
pub use stickslip::counted;

use crate::failure::{Hinted, hinted, one_line};
use crate::verdict::Verdict;

/// Writes results to standard output, with one newline at their end. Returns `Ok` also where the
/// reader has left.
pub fn show(text: impl Display) -> Result<()> {
    match write(&mut io::stdout().lock(), text) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(unwritable(&error)),
        _ => Ok(()),
    }
}

/// Shows a result: as one JSON object where `json` is set, else as text.
pub fn show_result(
    json: bool,
    result: &impl Serialize,
    text: impl FnOnce() -> String,
) -> Result<()> {
    show(if json {
        serde_json::to_string_pretty(result)?
    } else {
        text()
    })
}

/// Presence of a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reader {
    /// As far as one can know.
    Here,
    /// The reader has left.
    Gone,
}

/// Writes one line of many to standard output.
pub fn stream_line(line: &str) -> Result<Reader> {
    match write(&mut io::stdout().lock(), line) {
        Ok(()) => Ok(Reader::Here),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(Reader::Gone),
        Err(error) => Err(unwritable(&error)),
    }
}

fn unwritable(error: &io::Error) -> anyhow::Error {
    hinted(
        format!("standard output cannot be written: {error}"),
        "send it to a terminal, a pipe or a file with room for it",
    )
}

/// Most characters of a line on standard error; texts from a damaged file may be longer.
const LONGEST_LINE: usize = 2000;

/// Writes a line to standard error, without characters that a terminal would obey. It is lost where
/// it cannot be written, since there is no other place to say so.
pub fn talk(text: impl Display) {
    let _ = write(&mut io::stderr().lock(), printable(&text.to_string()));
}

/// A text whose control characters are written out, its middle left out where it is long.
fn printable(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let half = LONGEST_LINE / 2;
    let shown = |part: &[char]| {
        let plain = |c: &char| match c {
            '\n' | '\t' => c.to_string(),
            c if c.is_control() => c.escape_default().to_string(),
            c => c.to_string(),
        };
        part.iter().map(plain).collect::<String>()
    };
    match characters.len() {
        all if all <= LONGEST_LINE => shown(&characters),
        all => format!(
            "{} [{} characters left out] {}",
            shown(&characters[..half]),
            all - 2 * half,
            shown(&characters[all - half..])
        ),
    }
}

/// Writes the failure to standard error, and returns that error's exit code.
pub fn tell(error: &anyhow::Error) -> Verdict {
    if let Some(error) = error.downcast_ref::<clap::Error>() {
        // clap's own words; that they cannot be printed changes nothing
        let _ = error.print();
        return Verdict::BadArguments;
    }
    talk(said(error));
    Verdict::Failed
}

/// A failure in words, with the next step on a line of its own.
pub fn said(error: &anyhow::Error) -> String {
    let next = error.downcast_ref::<Hinted>();
    let next = next.map_or(String::new(), |hinted| format!("\nhelp: {}", hinted.help));
    format!("error: {}{next}", one_line(error))
}

fn write(stream: &mut impl Write, text: impl Display) -> io::Result<()> {
    writeln!(stream, "{}", text.to_string().trim_end())?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_printable_and_of_a_length_to_read() {
        assert_eq!(printable("a\u{1b}[2Jb\n"), "a\\u{1b}[2Jb\n");
        let long = printable(&format!("file: {}end", "x".repeat(1_000_000)));
        assert!(long.len() < 2100 && long.starts_with("file: x") && long.ends_with("xend"));
        assert!(long.contains("[998009 characters left out]"), "{long}");
    }
}
