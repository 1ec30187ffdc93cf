//! Messages of the program when something fails: one line `error: ...` and, where there is one, the
//! next step as `help: ...`.

use std::fmt;

/// An error with the next step.
#[derive(Debug)]
pub struct Hinted {
    message: String,
    /// The next step.
    pub help: String,
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

/// An error and its causes in one line.
pub fn one_line(error: &anyhow::Error) -> String {
    format!("{error:#}")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
