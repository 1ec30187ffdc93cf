//! Why a run was refused: [`RunError`].

use stickslip_filter::{SeriesError, SettingsError};

use crate::row::{LONGEST_PAUSE, RowError};

/// Why a method could not be run on a log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The log has no object pose at all (or all are hidden).
    #[error(
        "the log has no visible object pose in any of its {rows} rows; at least the first pose is needed to start from"
    )]
    NoObjectPose {
        /// Rows of the log.
        rows: usize,
    },
    /// Two rows are so far apart that nothing can be said of what happened between them.
    #[error(
        "row {row} is at {to} s and the row before it at {from} s; rows must be at most {longest} s apart. Give all times by one clock, or cut the log in the pause",
        longest = LONGEST_PAUSE
    )]
    Pause {
        /// The later row, from 0.
        row: usize,
        /// Time of the row before it (s).
        from: f64,
        /// Its time (s).
        to: f64,
    },
    /// The method weighs camera poses but the scene has no `[camera]`.
    #[error(
        "the scene has no [camera] table, which this method needs; add position_std and orientation_std"
    )]
    NoCamera,
    /// The pusher's or the object's poses could not be filtered.
    #[error("tracking by the constant-velocity Kalman filter failed: {0}")]
    Track(#[from] SeriesError),
    /// A row that no tracker can use.
    #[error(transparent)]
    Row(#[from] RowError),
    /// Filter settings out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// More sensors than fixels.
    #[error(
        "the log has {sensors} tactile columns but the scene has {fixels} fixels; sensor k is the k-th [[fixel]]"
    )]
    Sensors {
        /// Tactile columns.
        sensors: usize,
        /// Fixels of the scene.
        fixels: usize,
    },
}
