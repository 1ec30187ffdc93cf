//! Part of a recording by log times: [`LogTime`], [`BagPart`].

use std::fmt;
use std::str::FromStr;

use crate::log_mcap::message::SECOND;

/// Time at which a recorder wrote a message (ns); as text in seconds, `1750000011.007`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LogTime(pub u64);

/// Reason why a text is no log time.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no log time; write seconds, as 1750000011.007")]
pub struct LogTimeError(String);

/// Part of a recording, by the log times of its messages; both ends are in it. Static transforms
/// belong to every part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BagPart {
    /// First log time; `None`: from the beginning.
    pub from: Option<LogTime>,
    /// Last log time; `None`: to the end.
    pub to: Option<LogTime>,
}

impl BagPart {
    /// Returns true if it is the whole recording.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true if a message at a log time (ns) is in it.
    pub(crate) fn has(&self, log_time: u64) -> bool {
        let time = LogTime(log_time);
        self.from.is_none_or(|from| from <= time) && self.to.is_none_or(|to| time <= to)
    }
}

impl fmt::Display for LogTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let second = SECOND.unsigned_abs();
        write!(f, "{}.{:09}", self.0 / second, self.0 % second)
    }
}

impl FromStr for LogTime {
    type Err = LogTimeError;

    fn from_str(text: &str) -> Result<Self, LogTimeError> {
        let error = || LogTimeError(text.to_owned());
        let (whole, part) = text.split_once('.').unwrap_or((text, ""));
        let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if !is_number(whole) || !is_number(part) || part.len() > 9 {
            return Err(error());
        }
        let whole: u64 = whole.parse().map_err(|_| error())?;
        let part: u64 = format!("{part:0<9}").parse().map_err(|_| error())?;
        let time = whole.checked_mul(SECOND.unsigned_abs());
        let time = time.and_then(|whole| whole.checked_add(part));
        time.map(Self).ok_or_else(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_times_are_read_as_they_are_shown() {
        for (text, time) in [
            ("1750000011.007000001", 1_750_000_011_007_000_001),
            ("0.5", 500_000_000),
            ("3", 3_000_000_000),
        ] {
            let read: LogTime = text.parse().unwrap();
            assert_eq!(read, LogTime(time));
            assert_eq!(read.to_string().parse(), Ok(read));
        }
        for text in [
            "",
            "-1",
            "1e9",
            "1.0000000001",
            "99999999999999999999",
            "1.2.3",
        ] {
            let read: Result<LogTime, _> = text.parse();
            assert!(read.is_err(), "{text}");
        }
    }
}
