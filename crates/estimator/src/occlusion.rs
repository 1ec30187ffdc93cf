//! Rows whose object poses are hidden from a method: [`Occlusion`].

use crate::log::Log;

/// Occlusion of the camera. Scores still use the hidden poses as a reference.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Occlusion {
    /// Nothing is hidden.
    #[default]
    None,
    /// Rows `from` (included) to `to` (excluded; `None`: to the end).
    Rows {
        /// First hidden row.
        from: usize,
        /// First row that is visible again.
        to: Option<usize>,
    },
    /// Rows within this many seconds about the middle of the log, half on either side.
    Middle {
        /// Length of the occlusion (s).
        seconds: f64,
    },
}

impl Occlusion {
    /// Returns for every row whether its object pose is hidden.
    ///
    /// ```
    /// # use stickslip::{Log, Occlusion};
    /// let log = Log { time: vec![0.0, 0.1, 0.2, 0.3], object: vec![None; 4], pusher: vec![None; 4], ..Log::default() };
    /// assert_eq!(Occlusion::Rows { from: 1, to: Some(3) }.hidden(&log), [false, true, true, false]);
    /// ```
    pub fn hidden(&self, log: &Log) -> Vec<bool> {
        let (Some(first), Some(last)) = (log.time.first(), log.time.last()) else {
            return Vec::new();
        };
        let middle = 0.5 * (first + last);
        let hides = |row: usize| match *self {
            Occlusion::None => false,
            Occlusion::Rows { from, to } => row >= from && to.is_none_or(|to| row < to),
            Occlusion::Middle { seconds } => (log.time[row] - middle).abs() <= 0.5 * seconds,
        };
        (0..log.len()).map(hides).collect()
    }
}
