//! The pusher's own motion from its measured poses: [`PusherTrack`] (docs/method.md (30), (31)).
//!
//! Off-line it is the fixed-interval smoother of a constant-velocity Kalman filter per axis, as in
//! the paper. The level of its white-noise acceleration is the one of greatest likelihood over the
//! whole series. That level is not known causally: an interacting multiple model filter weighs
//! models from lively to nearly unaccelerated by how well each has predicted so far.
//!
//! A contact can only push, so a noisy position source ratchets the object forward by two or three
//! of its standard deviations. The track therefore has a first-order effect on the estimate.

use std::ops::Range;

use stickslip_dynamics::{Pose, PusherMotion};

use crate::error::RunError;
use crate::log::Log;
use crate::pusher::causal::CausalTrack;
use crate::pusher::smoothed::smoothed_track;
use crate::pusher::tracked_pose::{TrackedPose, motion, step_length};
use crate::setup::Camera;

/// Part of the log that the track may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tracking {
    /// All of it, before and after each row.
    #[default]
    Smoothed,
    /// Only the rows up to each one, as live.
    Causal,
}

/// Tracked pusher poses, one per log row; `None` while the pusher is off the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PusherTrack {
    rows: Vec<Option<TrackedPose>>,
    tracking: Tracking,
}

impl PusherTrack {
    /// Tracks the pusher of `log`; without a `camera` its poses count as exact.
    ///
    /// # Errors
    /// [`RunError::Track`] where a series cannot be filtered (numbers out of range).
    pub fn new(log: &Log, camera: Option<&Camera>, tracking: Tracking) -> Result<Self, RunError> {
        let rows = match tracking {
            Tracking::Smoothed => smoothed_track(log, camera)?,
            Tracking::Causal => {
                let mut track = CausalTrack::new(camera)?;
                let rows = log.time.iter().zip(&log.pusher);
                rows.map(|(time, pose)| track.push(*time, *pose)).collect()
            }
        };
        Ok(Self { rows, tracking })
    }

    /// Tracked pose of a row.
    pub fn pose(&self, row: usize) -> Option<Pose> {
        self.rows[row].map(|tracked| tracked.pose)
    }

    /// Direction that counts before the pusher has moved: off-line that of its first motion,
    /// causally a guess.
    pub fn first_direction(&self, time: &[f64]) -> [f64; 2] {
        const GUESS: [f64; 2] = [1.0, 0.0];
        const UNDECIDED: [f64; 2] = [0.0; 2];
        let directions = time.windows(2).enumerate().filter_map(|(row, pair)| {
            let motion = self.motion(row..row + 1, pair[1] - pair[0], UNDECIDED);
            Some(motion?.direction)
        });
        match self.tracking {
            Tracking::Smoothed => directions
                .into_iter()
                .find(|direction| *direction != UNDECIDED)
                .unwrap_or(GUESS),
            Tracking::Causal => GUESS,
        }
    }

    /// The pusher during a step from one row to another, of length `h` (s); `last` is its last
    /// direction of motion.
    ///
    /// It takes part where it is on the plane at both ends. A tracked velocity within a few
    /// standard deviations of zero does not change its direction.
    pub fn motion(&self, rows: Range<usize>, h: f64, last: [f64; 2]) -> Option<PusherMotion> {
        let at = |row: usize| self.rows.get(row).copied().flatten();
        motion(at(rows.start), at(rows.end), h, last)
    }

    /// Length (s) of the step to `row`, which comes `h` seconds after the last one.
    pub(crate) fn step_length(&self, row: usize, h: f64) -> f64 {
        step_length(self.rows.get(row).copied().flatten(), h)
    }

    /// Returns true if the pusher moves at the end of the step from `row`, as far as its track can
    /// tell.
    pub fn moves_after(&self, row: usize) -> bool {
        self.rows
            .get(row + 1)
            .copied()
            .flatten()
            .is_some_and(|tracked| tracked.moves())
    }
}
