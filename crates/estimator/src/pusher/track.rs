//! The pusher's own motion from its measured poses: [`PusherTrack`] (docs/method.md (30), (31)).
//!
//! Off-line it is the fixed-interval smoother of a constant-velocity Kalman filter, as in the
//! paper, per axis; the level of its white-noise acceleration is the one of greatest likelihood
//! over the whole series. Causally that level cannot be known: there a bank of filters from lively
//! to nearly unaccelerated runs side by side, each weighed by how well it has predicted so far. A
//! contact can only push, so a noisy position source ratchets the object forward by two or three of
//! its standard deviations: the track is a first-order error.

use stickslip_dynamics::{Pose, PusherMotion};
use stickslip_filter::AxisEstimate;

use crate::error::RunError;
use crate::log::Log;
use crate::pusher::causal::CausalTrack;
use crate::pusher::smoothed::smoothed_track;
use crate::setup::Camera;

/// Longest gap in the pusher's poses that its tracker bridges (s); in a longer one the pusher is
/// off the plane.
pub const LONGEST_BRIDGE: f64 = 0.2;

/// Standard deviation of a velocity about 0 at the first measurement (m/s, rad/s).
pub(crate) const INITIAL_VELOCITY_STD: f64 = 0.1;

/// Standard deviations of its own that a tracked speed must exceed to tell the pusher's direction.
const TELLING: f64 = 3.0;

/// Speed below which a pusher stands, however exactly its poses are known (m/s): the recoil of a
/// stalled drive tells no direction.
const STANDSTILL: f64 = 1e-5;

/// How much of the log the track may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tracking {
    /// All of it, before and after each row.
    #[default]
    Smoothed,
    /// Only the rows up to each one, as live.
    Causal,
}

/// The pusher at one row of its track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPose {
    /// Pose.
    pub pose: Pose,
    /// Velocity (m/s).
    pub velocity: [f64; 2],
    /// Standard deviation of the tracked speed (m/s); 0 where poses are exact.
    pub speed_std: f64,
}

impl TrackedPose {
    /// Of the tracked x, y and θ.
    pub(crate) fn of([x, y, theta]: [AxisEstimate; 3]) -> Self {
        Self {
            pose: Pose::new(x.position, y.position, theta.position),
            velocity: [x.velocity, y.velocity],
            speed_std: (x.velocity_variance + y.velocity_variance).sqrt(),
        }
    }

    /// Whether the tracked speed is more than what noise makes of a pusher that stands.
    pub fn moves(&self) -> bool {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        speed > TELLING * self.speed_std && speed > STANDSTILL
    }
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

    /// The direction that counts before the pusher has moved: off-line that of its first motion,
    /// causally a guess.
    pub fn first_direction(&self, time: &[f64]) -> [f64; 2] {
        const GUESS: [f64; 2] = [1.0, 0.0];
        const UNDECIDED: [f64; 2] = [0.0; 2];
        let directions = time.windows(2).enumerate().filter_map(|(row, pair)| {
            Some(self.motion(row, pair[1] - pair[0], UNDECIDED)?.direction)
        });
        match self.tracking {
            Tracking::Smoothed => directions
                .into_iter()
                .find(|direction| *direction != UNDECIDED)
                .unwrap_or(GUESS),
            Tracking::Causal => GUESS,
        }
    }

    /// The pusher during the step from `row` to the next, of length `h` (s); `last` is its last
    /// direction of motion.
    ///
    /// It takes part where it is on the plane at both ends. A tracked velocity within a few
    /// standard deviations of zero does not change its direction.
    pub fn motion(&self, row: usize, h: f64, last: [f64; 2]) -> Option<PusherMotion> {
        motion(
            self.rows[row],
            self.rows.get(row + 1).copied().flatten(),
            h,
            last,
        )
    }

    /// Whether the pusher moves at the end of the step from `row`, as far as its track can tell.
    pub fn moves_after(&self, row: usize) -> bool {
        self.rows
            .get(row + 1)
            .copied()
            .flatten()
            .is_some_and(|tracked| tracked.moves())
    }
}

/// The pusher during a step of length `h` (s) from `now` to `next`; `last` is its last direction of
/// motion.
pub(crate) fn motion(
    now: Option<TrackedPose>,
    next: Option<TrackedPose>,
    h: f64,
    last: [f64; 2],
) -> Option<PusherMotion> {
    let (now, next) = (now?, next?);
    // not that of the step, which holds the corrections of a causal track: they may point
    // backwards
    let [vx, vy] = next.velocity;
    let direction = if next.moves() {
        [vx / vx.hypot(vy), vy / vx.hypot(vy)]
    } else {
        last
    };
    Some(PusherMotion {
        pose: now.pose,
        twist: now.pose.twist_to(next.pose, h),
        direction,
    })
}

/// Whether a gap from `from` to `to` (s) without a pusher pose is bridged.
pub(crate) fn bridged(from: f64, to: f64) -> bool {
    to - from <= LONGEST_BRIDGE + 1e-9
}
