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

use stickslip_dynamics::{MOST_FINGERS, Pose, PusherMotion};

use crate::error::RunError;
use crate::log::Log;
use crate::pusher::causal::CausalTrack;
use crate::pusher::smoothed::smoothed_track;
use crate::pusher::tracked_pose::{Directions, TrackedPose, motion, moves, step_length};
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

/// Tracked poses of the pusher's fingers, row by row; `None` while a finger is off the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PusherTrack {
    /// The fingers of the first row, then those of the second, ...
    rows: Vec<Option<TrackedPose>>,
    fingers: usize,
    tracking: Tracking,
}

impl PusherTrack {
    /// Tracks the fingers of `log`; without a `camera` their poses count as exact.
    ///
    /// # Errors
    /// [`RunError::Track`] where a series cannot be filtered (numbers out of range).
    pub fn new(log: &Log, camera: Option<&Camera>, tracking: Tracking) -> Result<Self, RunError> {
        let fingers = 1 + log.other_fingers.len();
        let mut rows = vec![None; fingers * log.len()];
        for (finger, poses) in log.fingers().enumerate() {
            let tracked = match tracking {
                Tracking::Smoothed => smoothed_track(&log.time, poses, camera)?,
                Tracking::Causal => {
                    let mut track = CausalTrack::new(camera)?;
                    let rows = log.time.iter().zip(poses);
                    rows.map(|(time, pose)| track.push(*time, *pose)).collect()
                }
            };
            for (row, tracked) in tracked.into_iter().enumerate() {
                rows[row * fingers + finger] = tracked;
            }
        }
        Ok(Self {
            rows,
            fingers,
            tracking,
        })
    }

    /// Tracked pose of the pusher at a row: of a hand of several fingers their mean position, with
    /// the angle of the first.
    pub fn pose(&self, row: usize) -> Option<Pose> {
        let fingers = self.at(row).iter();
        let poses: Option<Vec<Pose>> = fingers.map(|f| f.map(|tracked| tracked.pose)).collect();
        let poses = poses?;
        let share = 1.0 / poses.len() as f64;
        match poses[..] {
            [alone] => Some(alone),
            _ => Some(Pose {
                x: poses.iter().fold(0.0, |sum, pose| sum + share * pose.x),
                y: poses.iter().fold(0.0, |sum, pose| sum + share * pose.y),
                theta: poses.first()?.theta,
            }),
        }
    }

    /// The fingers at a row; empty beyond the log.
    fn at(&self, row: usize) -> &[Option<TrackedPose>] {
        let from = row * self.fingers;
        self.rows.get(from..from + self.fingers).unwrap_or_default()
    }

    /// Directions that count before a finger has moved: off-line those of its first motion,
    /// causally a guess.
    pub(crate) fn first_directions(&self, time: &[f64]) -> Directions {
        const GUESS: [f64; 2] = [1.0, 0.0];
        const UNDECIDED: [f64; 2] = [0.0; 2];
        let mut first = [GUESS; MOST_FINGERS];
        if self.tracking == Tracking::Causal {
            return first;
        }
        for (finger, first) in first.iter_mut().enumerate().take(self.fingers) {
            let undecided = [UNDECIDED; MOST_FINGERS];
            let directions = time.windows(2).enumerate().filter_map(|(row, pair)| {
                let motion = self.motion(row..row + 1, pair[1] - pair[0], &undecided)?;
                Some(motion[finger].direction)
            });
            let mut decided = directions.filter(|direction| *direction != UNDECIDED);
            *first = decided.next().unwrap_or(GUESS);
        }
        first
    }

    /// The pusher during a step from one row to another, of length `h` (s); `last` has the last
    /// directions of motion of its fingers.
    ///
    /// It takes part where all its fingers are on the plane at both ends. A tracked velocity within
    /// a few standard deviations of zero does not change a finger's direction.
    pub(crate) fn motion(
        &self,
        rows: Range<usize>,
        h: f64,
        last: &Directions,
    ) -> Option<PusherMotion> {
        motion(self.at(rows.start), self.at(rows.end), h, last)
    }

    /// Length (s) of the step to `row`, which comes `h` seconds after the last one.
    pub(crate) fn step_length(&self, row: usize, h: f64) -> f64 {
        step_length(self.at(row), h)
    }

    /// Returns true if the pusher moves at the end of the step from `row`, as far as its track can
    /// tell.
    pub fn moves_after(&self, row: usize) -> bool {
        moves(self.at(row + 1))
    }
}
