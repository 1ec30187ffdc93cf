//! One recorded experiment: [`Log`], columns of equal length, one row per camera frame.

use stickslip_dynamics::Pose;

use crate::row::Row;

/// A recorded experiment; every column has one entry per row, `None` where nothing was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Time (s), strictly rising.
    pub time: Vec<f64>,
    /// Measured object poses.
    pub object: Vec<Option<Pose>>,
    /// Measured pusher poses.
    pub pusher: Vec<Option<Pose>>,
    /// Tactile readings: one column per fixel sensor, over the interval that ends at the row.
    pub tactile: Vec<Vec<Option<bool>>>,
    /// Force of the pusher on the object, world frame (N); empty where the log has no force
    /// columns.
    pub force: Vec<Option<[f64; 2]>>,
}

impl Log {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Time from the first row to the last (s); 0 where there is none.
    pub fn duration(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0) - self.time.first().copied().unwrap_or(0.0)
    }

    /// What was measured at row `row`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> Row {
        Row {
            time: self.time[row],
            object: self.object[row],
            pusher: self.pusher[row],
            tactile: self.tactile.iter().map(|sensor| sensor[row]).collect(),
            force: self.force.get(row).copied().flatten(),
        }
    }

    /// True where there is no row.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}
