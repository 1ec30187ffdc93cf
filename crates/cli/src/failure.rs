//! What the program says when something fails: one line `error: ...` and, where there is one, the
//! next step as `help: ...`.

use std::fmt;

use crate::output::talk;
use crate::verdict::Verdict;

/// An error with the next step.
#[derive(Debug)]
pub struct Hinted {
    message: String,
    help: String,
}

impl fmt::Display for Hinted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Hinted {}

/// An error that says what to do next.
pub fn hinted(message: impl Into<String>, help: impl Into<String>) -> anyhow::Error {
    anyhow::Error::new(Hinted {
        message: message.into(),
        help: help.into(),
    })
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

/// An error and its causes in one line.
pub fn one_line(error: &anyhow::Error) -> String {
    format!("{error:#}")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
