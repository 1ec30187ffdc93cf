//! The pusher's own motion from its measured poses: [`PusherTrack`].
//!
//! Off-line it is the fixed-interval smoother of a constant-velocity Kalman filter, as in the
//! paper, per axis; the level of its white-noise acceleration is the one of greatest likelihood
//! over the whole series. Causally that level cannot be known: there a bank of filters from lively
//! to nearly unaccelerated runs side by side, each weighed by how well it has predicted so far. A
//! contact can only push, so a noisy position source ratchets the object forward by two or three of
//! its standard deviations: the track is a first-order error.

use std::ops::Range;

use stickslip_dynamics::{Pose, PusherMotion};
use stickslip_filter::{AxisEstimate, ConstantVelocity, InteractingMultipleModel};

use crate::{Camera, Log, RunError};

/// Longest gap in the pusher's poses that its tracker bridges (s); in a longer one the pusher is
/// off the plane.
pub const LONGEST_BRIDGE: f64 = 0.2;

/// Standard deviation of a velocity about 0 at the first measurement (m/s, rad/s).
const INITIAL_VELOCITY_STD: f64 = 0.1;

/// Modes of the causal track: times T (s) in which the noise of the motion reaches that of one
/// measurement, q = std²/T³.
const LIVELINESS: [f64; 3] = [10.0, 0.5, 0.05];

/// Mean time for which one of these modes holds (s).
const MEAN_SOJOURN_TIME: f64 = 30.0;

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
    /// Whether the tracked speed is more than what noise makes of a pusher that stands.
    fn moves(&self) -> bool {
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
        let mut rows = vec![None; log.len()];
        for span in spans(log, tracking) {
            let time = &log.time[span.clone()];
            let seen = &log.pusher[span.clone()];
            let poses = track_span(time, seen, camera, tracking)?;
            for (row, pose) in rows[span].iter_mut().zip(poses) {
                *row = Some(pose);
            }
        }
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
        let (now, next) = (self.rows[row]?, self.rows.get(row + 1).copied().flatten()?);
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

    /// Whether the pusher moves at the end of the step from `row`, as far as its track can tell.
    pub fn moves_after(&self, row: usize) -> bool {
        self.rows
            .get(row + 1)
            .copied()
            .flatten()
            .is_some_and(|tracked| tracked.moves())
    }
}

/// Row ranges in which the pusher is on the plane: from a first pose to the last before a gap that
/// is too long.
///
/// Causally nobody knows of a gap how long it will be: the pusher stays until it is too long.
fn spans(log: &Log, tracking: Tracking) -> Vec<Range<usize>> {
    let bridged = |from: usize, to: usize| log.time[to] - log.time[from] <= LONGEST_BRIDGE + 1e-9;
    let mut spans: Vec<Range<usize>> = Vec::new();
    for row in (0..log.len()).filter(|&row| log.pusher[row].is_some()) {
        match spans.last_mut() {
            Some(span) if bridged(span.end - 1, row) => span.end = row + 1,
            _ => spans.push(row..row + 1),
        }
    }
    for span in &mut spans {
        let last = span.end - 1;
        let held = (span.end..log.len())
            .take_while(|&row| bridged(last, row))
            .count();
        // a gap that runs to the end of the log is bridged like any other
        if tracking == Tracking::Causal || span.end + held == log.len() {
            span.end += held;
        }
    }
    spans
}

fn track_span(
    time: &[f64],
    seen: &[Option<Pose>],
    camera: Option<&Camera>,
    tracking: Tracking,
) -> Result<Vec<TrackedPose>, RunError> {
    let axis = |pick: fn(&Pose) -> f64, std: f64| {
        let measured: Vec<Option<f64>> = seen.iter().map(|pose| pose.as_ref().map(pick)).collect();
        track_axis(time, &measured, std, tracking)
    };
    let (position_std, orientation_std) = camera.map_or((0.0, 0.0), |c| {
        (c.pusher_position_std, c.pusher_orientation_std)
    });
    let position = || {
        rayon::join(
            || axis(|p| p.x, position_std),
            || axis(|p| p.y, position_std),
        )
    };
    let ((x, y), theta) = rayon::join(position, || axis(|p| p.theta, orientation_std));
    let tracked = x?
        .into_iter()
        .zip(y?)
        .zip(theta?)
        .map(|((x, y), theta)| TrackedPose {
            pose: Pose::new(x.position, y.position, theta.position),
            velocity: [x.velocity, y.velocity],
            speed_std: (x.velocity_variance + y.velocity_variance).sqrt(),
        });
    Ok(tracked.collect())
}

fn track_axis(
    time: &[f64],
    measured: &[Option<f64>],
    std: f64,
    tracking: Tracking,
) -> Result<Vec<AxisEstimate>, RunError> {
    let too_few = tracking == Tracking::Smoothed && measured.iter().flatten().count() < 3;
    if std == 0.0 || too_few {
        return Ok(bridge(time, measured, tracking));
    }
    let model = |process_noise: f64| ConstantVelocity {
        process_noise,
        measurement_std: std,
        initial_velocity_std: INITIAL_VELOCITY_STD,
    };
    let rows = match tracking {
        Tracking::Smoothed => model(model(0.0).fit_process_noise(time, measured)?.process_noise)
            .smooth(time, measured)?,
        Tracking::Causal => {
            let modes = LIVELINESS
                .iter()
                .map(|t| model(std * std / (t * t * t)))
                .collect();
            hold(
                InteractingMultipleModel {
                    modes,
                    mean_sojourn_time: MEAN_SOJOURN_TIME,
                }
                .filter(time, measured)?
                .rows,
                measured,
            )
        }
    };
    Ok(rows.into_iter().flatten().collect())
}

/// Live, the last estimate is held while the pusher is not seen, not extrapolated.
fn hold(
    mut rows: Vec<Option<AxisEstimate>>,
    measured: &[Option<f64>],
) -> Vec<Option<AxisEstimate>> {
    for row in 1..rows.len() {
        if measured[row].is_none() {
            rows[row] = rows[row - 1].map(|before| AxisEstimate {
                velocity: 0.0,
                ..before
            });
        }
    }
    rows
}

/// Exact poses: gaps are interpolated off-line and held live. The first row is measured.
fn bridge(time: &[f64], measured: &[Option<f64>], tracking: Tracking) -> Vec<AxisEstimate> {
    let mut before = (time[0], measured[0].unwrap_or(0.0));
    let positions = (0..time.len()).map(|row| {
        if let Some(value) = measured[row] {
            before = (time[row], value);
            return value;
        }
        let after =
            (row..time.len()).find_map(|later| measured[later].map(|value| (time[later], value)));
        match (tracking, after) {
            (Tracking::Smoothed, Some((t, value))) => {
                before.1 + (value - before.1) * (time[row] - before.0) / (t - before.0)
            }
            _ => before.1,
        }
    });
    let positions: Vec<f64> = positions.collect();
    let velocity = |row: usize| {
        if row == 0 {
            0.0
        } else {
            (positions[row] - positions[row - 1]) / (time[row] - time[row - 1])
        }
    };
    let at = |row: usize| AxisEstimate {
        position: positions[row],
        velocity: velocity(row),
        position_variance: 0.0,
        velocity_variance: 0.0,
    };
    (0..time.len()).map(at).collect()
}
