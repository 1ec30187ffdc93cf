//! The pusher's own motion from its measured poses: [`PusherTrack`].
//!
//! Off-line it is the fixed-interval smoother of a constant-velocity Kalman filter, as in the paper; causally it is the filter.
//! The level of the white-noise acceleration is the one of greatest likelihood, per axis. A contact can only push, so a noisy
//! position source ratchets the object forward by two or three of its standard deviations: the track is a first-order error.

use stickslip_dynamics::{Pose, PusherMotion};
use stickslip_filter::{AxisEstimate, ConstantVelocity};

use crate::{Camera, Log, RunError};

/// Longest gap in the pusher's poses that its tracker bridges (s); in a longer one the pusher is off the plane.
pub const LONGEST_BRIDGE: f64 = 0.2;

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
    /// Standard deviation of the tracked speed (m/s); 0 where poses are exact.
    pub speed_std: f64,
}

/// Tracked pusher poses, one per log row; `None` while the pusher is off the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct PusherTrack {
    rows: Vec<Option<TrackedPose>>,
}

impl PusherTrack {
    /// Tracks the pusher of `log`; without a `camera` its poses count as exact.
    ///
    /// # Errors
    /// [`RunError::Track`] where a series cannot be filtered (numbers out of range).
    pub fn new(log: &Log, camera: Option<&Camera>, tracking: Tracking) -> Result<Self, RunError> {
        let mut rows = vec![None; log.len()];
        for span in spans(log) {
            let time = &log.time[span.clone()];
            let seen = &log.pusher[span.clone()];
            let poses = track_span(time, seen, camera, tracking)?;
            for (row, pose) in rows[span].iter_mut().zip(poses) {
                *row = Some(pose);
            }
        }
        Ok(Self { rows })
    }

    /// Tracked pose of a row.
    pub fn pose(&self, row: usize) -> Option<Pose> {
        self.rows[row].map(|tracked| tracked.pose)
    }

    /// The pusher during the step from `row` to the next, of length `h` (s); `last` is its last direction of motion.
    ///
    /// It takes part where it is on the plane at both ends. A speed within two standard deviations of zero does not
    /// change its direction.
    pub fn motion(&self, row: usize, h: f64, last: [f64; 2]) -> Option<PusherMotion> {
        let (now, next) = (self.rows[row]?, self.rows.get(row + 1).copied().flatten()?);
        let twist = now.pose.twist_to(next.pose, h);
        let speed = twist.vx.hypot(twist.vy);
        let moves = speed > 2.0 * next.speed_std && speed > 1e-9;
        let direction = if moves { [twist.vx / speed, twist.vy / speed] } else { last };
        Some(PusherMotion { pose: now.pose, twist, direction })
    }
}

/// Row ranges in which the pusher is on the plane: from its first pose to the last before a gap that is too long.
fn spans(log: &Log) -> Vec<std::ops::Range<usize>> {
    let mut spans: Vec<std::ops::Range<usize>> = Vec::new();
    let seen = (0..log.len()).filter(|&row| log.pusher[row].is_some());
    for row in seen {
        match spans.last_mut() {
            Some(span) if log.time[row] - log.time[span.end - 1] <= LONGEST_BRIDGE + 1e-9 => span.end = row + 1,
            _ => spans.push(row..row + 1),
        }
    }
    // a gap that runs to the end of the log is bridged like any other
    if let Some(span) = spans.last_mut()
        && log.time[log.len() - 1] - log.time[span.end - 1] <= LONGEST_BRIDGE + 1e-9
    {
        span.end = log.len();
    }
    spans
}

fn track_span(time: &[f64], seen: &[Option<Pose>], camera: Option<&Camera>, tracking: Tracking) -> Result<Vec<TrackedPose>, RunError> {
    let axis = |pick: fn(&Pose) -> f64, std: f64| {
        let measured: Vec<Option<f64>> = seen.iter().map(|pose| pose.as_ref().map(pick)).collect();
        track_axis(time, &measured, std, tracking)
    };
    let (position_std, orientation_std) = camera.map_or((0.0, 0.0), |c| (c.pusher_position_std, c.pusher_orientation_std));
    let x = axis(|p| p.x, position_std)?;
    let y = axis(|p| p.y, position_std)?;
    let theta = axis(|p| p.theta, orientation_std)?;
    let tracked = x.iter().zip(&y).zip(&theta).map(|((x, y), theta)| TrackedPose {
        pose: Pose::new(x.position, y.position, theta.position),
        speed_std: (x.velocity_variance + y.velocity_variance).sqrt(),
    });
    Ok(tracked.collect())
}

fn track_axis(time: &[f64], measured: &[Option<f64>], std: f64, tracking: Tracking) -> Result<Vec<AxisEstimate>, RunError> {
    if std == 0.0 || measured.iter().flatten().count() < 3 {
        return Ok(bridge(time, measured, tracking));
    }
    let mut model = ConstantVelocity { process_noise: 0.0, measurement_std: std, initial_velocity_std: 0.1 };
    model.process_noise = model.fit_process_noise(time, measured)?.process_noise;
    let rows = match tracking {
        Tracking::Smoothed => model.smooth(time, measured)?,
        Tracking::Causal => hold(model.filter(time, measured)?.rows, measured),
    };
    Ok(rows.into_iter().flatten().collect())
}

/// Live, the last estimate is held while the pusher is not seen, not extrapolated.
fn hold(mut rows: Vec<Option<AxisEstimate>>, measured: &[Option<f64>]) -> Vec<Option<AxisEstimate>> {
    for row in 1..rows.len() {
        if measured[row].is_none() {
            rows[row] = rows[row - 1].map(|before| AxisEstimate { velocity: 0.0, ..before });
        }
    }
    rows
}

/// Exact poses: gaps are interpolated off-line and held live. The first row is measured.
fn bridge(time: &[f64], measured: &[Option<f64>], tracking: Tracking) -> Vec<AxisEstimate> {
    let mut before = (time[0], measured[0].unwrap_or(0.0));
    let position = (0..time.len()).map(|row| {
        if let Some(value) = measured[row] {
            before = (time[row], value);
            return value;
        }
        let after = (row..time.len()).find_map(|later| measured[later].map(|value| (time[later], value)));
        match (tracking, after) {
            (Tracking::Smoothed, Some((t, value))) => before.1 + (value - before.1) * (time[row] - before.0) / (t - before.0),
            _ => before.1,
        }
    });
    position.map(|position| AxisEstimate { position, velocity: 0.0, position_variance: 0.0, velocity_variance: 0.0 }).collect()
}
