//! Outcome of the program: [`Verdict`], an exit code.

/// Outcome of the program.
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
    /// Outcome of two parts together, neither of which failed: input is lost where one of them lost
    /// some.
    pub fn and(self, other: Self) -> Self {
        match self {
            Self::Done => other,
            worse => worse,
        }
    }

    /// The process's exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::BadArguments => 2,
            Self::InputLost => 3,
        }
    }
}
