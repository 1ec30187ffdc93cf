//! The one place where the program speaks: results by [`show`] on standard output, all else by
//! [`talk`] on standard error.
//!
//! A reader may leave early, as `head` does. That is no failure: what is left to tell is dropped,
//! files are still written, and the exit code is that of the work.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use anyhow::Result;
use serde::Serialize;

use crate::failure::{Hinted, hinted, one_line};
use crate::verdict::Verdict;

/// Writes results to standard output, with one newline at their end; to nobody where the reader has
/// left.
pub fn show(text: impl Display) -> Result<()> {
    match write(&mut io::stdout().lock(), text) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(hinted(
            format!("standard output cannot be written: {error}"),
            "send it to a terminal, a pipe or a file with room for it",
        )),
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

/// Writes a line to standard error; lost where nobody can read it, since there is no other place to
/// say so.
pub fn talk(text: impl Display) {
    let _ = write(&mut io::stderr().lock(), text);
}

/// Tells standard error what failed, and ends with that error's exit code.
pub fn tell(error: &anyhow::Error) -> Verdict {
    if let Some(error) = error.downcast_ref::<clap::Error>() {
        // clap's own words; that they cannot be told changes nothing
        let _ = error.print();
        return Verdict::BadArguments;
    }
    talk(format_args!("error: {}", one_line(error)));
    if let Some(hinted) = error.downcast_ref::<Hinted>() {
        talk(format_args!("help: {}", hinted.help));
    }
    Verdict::Failed
}

fn write(stream: &mut impl Write, text: impl Display) -> io::Result<()> {
    writeln!(stream, "{}", text.to_string().trim_end())?;
    stream.flush()
}
