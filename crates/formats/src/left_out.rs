//! Measurements of a recording that its log lacks: [`LeftOut`].

use std::fmt;

use serde::Serialize;

/// Measurements of a recording that are in no row of its log, counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Topic, and frames where it carries transforms; as `--topic` takes it.
    pub place: String,
    /// Number of measurements.
    pub count: usize,
    /// Number of all measurements there.
    pub of: usize,
    /// Reason.
    #[serde(flatten)]
    pub reason: Reason,
}

/// Reason why measurements are in no row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "reason")]
#[non_exhaustive]
pub enum Reason {
    /// The numbers are those of a body that was not seen: a quaternion of zeros, NaN.
    NotMeasured,
    /// The stamp is 0: its sender had no clock yet.
    Unstamped,
    /// The message is equal to an earlier one, stamp and all.
    Repeated,
    /// Other transforms on the way between the frames are not known at that time.
    Unlinked,
    /// The measurements are before or after all poses.
    OtherTime {
        /// Times of the topic.
        at: String,
        /// Times of the poses.
        poses: String,
    },
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            place, count, of, ..
        } = self;
        write!(f, "{place}: {count} of {of} ")?;
        match &self.reason {
            Reason::NotMeasured => f.write_str(
                "measurements are left out: a quaternion of zeros or a number that is not finite means that nothing was measured",
            ),
            Reason::Unstamped => f.write_str(
                "messages are left out: their header.stamp is 0, and that of others is not",
            ),
            Reason::Repeated => f.write_str(
                "messages are left out: each is equal to an earlier one. Record the topic once",
            ),
            Reason::Unlinked => f.write_str(
                "poses are left out: the other transforms between the frames are not known within 0.2 s of them. Record all transforms by one clock",
            ),
            Reason::OtherTime { at, poses } => write!(
                f,
                "messages are left out: the topic is at {at}, the poses at {poses}. Record all topics by one clock",
            ),
        }
    }
}
