//! Oddities of a log that did not keep it from being read: [`LogWarning`].

use std::fmt;

/// Something in a log that was read over.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LogWarning {
    /// Columns that the format does not have.
    ExtraColumns {
        /// Display name of the file.
        file: String,
        /// Their names.
        columns: Vec<String>,
    },
    /// A recording that is cut off or damaged; it was read up to there.
    CutOff {
        /// Display name of the file.
        file: String,
        /// Bytes that were read.
        at: u64,
        /// Bytes of the file.
        size: u64,
        /// The fault there.
        why: String,
    },
    /// Poses that are not in the plane; only their turn about the vertical was read.
    Tilted {
        /// Display name of the file.
        file: String,
        /// Name of the topic.
        topic: String,
        /// Number of poses tilted by more than 5°.
        count: usize,
        /// Number of all poses.
        of: usize,
        /// Largest tilt (rad).
        largest: f64,
    },
    /// Frames whose pose is not known at some stamps, since other transforms between them are not.
    Unlinked {
        /// Display name of the bag.
        file: String,
        /// Topic and frames.
        place: String,
        /// Number of stamps.
        count: usize,
        /// Of how many.
        of: usize,
    },
    /// Covariances that are none; their poses count as if nothing were said of their noise.
    NoCovariance {
        /// Display name of the bag.
        file: String,
        /// Name of the topic.
        topic: String,
        /// Number of covariances.
        count: usize,
        /// Of how many poses.
        of: usize,
    },
    /// A topic whose messages are all at other times than the poses; its cells are empty.
    Elsewhere {
        /// Display name of the file.
        file: String,
        /// Name of the topic.
        topic: String,
        /// Its times.
        at: String,
        /// Those of the poses.
        rows: String,
    },
}

impl LogWarning {
    /// Returns true if some of the file could not be read.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::CutOff { .. })
    }
}

impl fmt::Display for LogWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ExtraColumns { file, columns } => write!(
                f,
                "{file}:1: extra columns are ignored: {}",
                columns.join(", ")
            ),
            Self::CutOff {
                file,
                at,
                size,
                why,
            } => {
                write!(
                    f,
                    "{file}: the recording is cut off or damaged after {at} of {size} bytes ({why}); what follows is lost"
                )
            }
            Self::Tilted {
                file,
                topic,
                count,
                of,
                largest,
            } => write!(
                f,
                "{file}: {topic}: {count} of {of} poses are tilted by more than 5 deg, the most by {:.1} deg; only their turn about z is read. Check that the z-axis points up from the table",
                largest.to_degrees()
            ),
            Self::Unlinked {
                file,
                place,
                count,
                of,
            } => write!(
                f,
                "{file}: {place}: at {count} of {of} stamps the transforms between are not known within 0.2 s; these poses are left out. Record all transforms by one clock"
            ),
            Self::NoCovariance {
                file,
                topic,
                count,
                of,
            } => write!(
                f,
                "{file}: {topic}: {count} of {of} covariances of x, y and the turn about z are not symmetric and positive definite, with standard deviations of at least 1e-9; these poses get the standard deviations of the scene's [camera]. Publish zeros where the covariance is not known"
            ),
            Self::Elsewhere {
                file,
                topic,
                at,
                rows,
            } => write!(
                f,
                "{file}: {topic}: all messages are at {at} and the poses at {rows}, so its cells are empty. Record all topics by one clock"
            ),
        }
    }
}
