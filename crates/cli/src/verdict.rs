//! How the program ended: [`Verdict`], an exit code.

use std::process::ExitCode;

/// How the program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All was done.
    Done,
    /// Nothing was done, or problems were found.
    Failed,
    /// The arguments do not go together.
    BadArguments,
    /// Some of the input was lost, the rest is done.
    InputLost,
}

impl Verdict {
    /// How two parts ended together, neither of which failed: input is lost where one of them lost some.
    pub fn and(self, other: Self) -> Self {
        match self {
            Self::Done => other,
            worse => worse,
        }
    }

    /// The process's exit code.
    pub fn exit_code(self) -> ExitCode {
        match self {
            Self::Done => ExitCode::SUCCESS,
            Self::Failed => ExitCode::from(1),
            Self::BadArguments => ExitCode::from(2),
            Self::InputLost => ExitCode::from(3),
        }
    }
}
