//! Oddities of a log that did not keep it from being read: [`LogWarning`].

use std::fmt;

use crate::left_out::LeftOut;

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
    /// Measurements of a recording that are in no row.
    LeftOut {
        /// Display name of the bag.
        file: String,
        /// Their place, number and reason.
        left_out: LeftOut,
    },
    /// Topics of poses, forces and touches that no key is mapped to.
    Unread {
        /// Display name of the bag.
        file: String,
        /// Their names.
        topics: Vec<String>,
        /// Number of their messages.
        messages: usize,
    },
    /// Messages that were recorded after later ones; they are sorted by stamp.
    Late {
        /// Display name of the bag.
        file: String,
        /// Topic, and frames where it carries transforms.
        place: String,
        /// Number of messages.
        count: usize,
        /// Longest delay (s).
        longest: f64,
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
}

impl LogWarning {
    /// Returns true if some of the file could not be read.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::CutOff { .. })
    }

    /// Returns the measurements that were left out, if it is about some.
    #[must_use]
    pub fn left_out(&self) -> Option<&LeftOut> {
        if let Self::LeftOut { left_out, .. } = self {
            Some(left_out)
        } else {
            None
        }
    }
}

/// Names in a row; the first ones of many, each cut off where it is very long.
pub(crate) fn listed(names: &[String]) -> String {
    const MOST: usize = 20;
    const LONGEST: usize = 100;
    let short = |name: &String| match name.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.clone(),
    };
    let shown: Vec<String> = names.iter().take(MOST).map(short).collect();
    match names.len().checked_sub(MOST) {
        None | Some(0) => shown.join(", "),
        Some(more) => format!("{} and {more} more", shown.join(", ")),
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
            Self::LeftOut { file, left_out } => write!(f, "{file}: {left_out}"),
            Self::Unread {
                file,
                topics,
                messages,
            } => write!(
                f,
                "{file}: not read: {messages} messages of {}. Map a topic that belongs to the log",
                listed(topics)
            ),
            Self::Late {
                file,
                place,
                count,
                longest,
            } => write!(
                f,
                "{file}: {place}: {count} messages were recorded after later ones, by up to {:.1} ms; they are sorted by header.stamp. Check the clocks of what publishes them",
                1e3 * longest
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
        }
    }
}
