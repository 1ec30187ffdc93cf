//! Reasons for which a run is refused: [`RunError`].

use stickslip_filter::{SeriesError, SettingsError};

use crate::counted::counted;
use crate::range::SetupError;
use crate::row::{LONGEST_PAUSE, RowError, counted_bodies};

/// Reason why a method could not be run on a log.
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
    /// Two rows are too far apart: what happened between them is unknown.
    #[error(
        "row {row} is at {to} s and the row before it at {from} s; rows must be at most {longest} s apart{}. Give all times in seconds and by one clock, or cut the log in the pause",
        .unit.map_or(String::new(), |unit| format!("; times seem to be in {unit}")),
        longest = LONGEST_PAUSE
    )]
    Pause {
        /// The later row, from 0.
        row: usize,
        /// Time of the row before it (s).
        from: f64,
        /// Its time (s).
        to: f64,
        /// The unit that the log's times seem to be in, where it is not the second.
        unit: Option<&'static str>,
    },
    /// Columns of a log differ in length.
    #[error(
        "the log's column `{column}` has {entries} entries and `time` {rows}; give every row an entry, None where nothing was measured"
    )]
    Columns {
        /// The column.
        column: String,
        /// Its entries.
        entries: usize,
        /// Rows of the log.
        rows: usize,
    },
    /// Times do not rise.
    #[error(
        "row {row} is at {to} s and the row before it at {from} s; time must rise strictly from row to row. Sort the rows and remove repeated ones"
    )]
    Order {
        /// The later row, from 0.
        row: usize,
        /// Time of the row before it (s).
        from: f64,
        /// Its time (s).
        to: f64,
    },
    /// A row of a log that cannot be used.
    #[error("row {row}: {problem}")]
    LogRow {
        /// The row, from 0.
        row: usize,
        /// The reason.
        problem: RowError,
    },
    /// A number of the setup is not possible.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A forced number of substeps is out of range.
    #[error(
        "{substeps} substeps are asked for from row to row; it must be 1 to {most}, or None to choose by the length of the step"
    )]
    Substeps {
        /// The number asked for.
        substeps: u32,
        /// The largest one.
        most: u32,
    },
    /// The time for which late rows may count is out of range.
    #[error("late rows are to count for {late} s; it must be from 0 to {LONGEST_PAUSE} s")]
    Late {
        /// The time asked for (s).
        late: f64,
    },
    /// The system does not provide the memory.
    #[error(
        "{particles} particles take about {megabytes} MB, which the system does not give; ask for fewer particles"
    )]
    Memory {
        /// Particles asked for.
        particles: usize,
        /// Memory that they take (MB).
        megabytes: usize,
    },
    /// The method weighs camera poses, but the scene has no `[camera]`.
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
    /// More sensors than bodies for them.
    #[error(
        "the log has {} but the scene has {}; sensor k is the k-th [[fixel]], or behind them a finger of a hand",
        counted(*.sensors as u64, "tactile column"),
        counted_bodies(*.fixels, *.fingers)
    )]
    Sensors {
        /// Tactile columns.
        sensors: usize,
        /// Fixels of the scene.
        fixels: usize,
        /// Fingers of the scene.
        fingers: usize,
    },
    /// Another number of fingers than the scene's.
    #[error(
        "the log has poses of {} besides the pusher but the scene has {}; [[finger]] k has its pose in finger_k_x, finger_k_y and finger_k_theta",
        counted(*.found as u64, "finger"), counted(*.fingers as u64, "[[finger]] table")
    )]
    Fingers {
        /// Fingers of the log besides the pusher.
        found: usize,
        /// `[[finger]]` tables of the scene.
        fingers: usize,
    },
}
