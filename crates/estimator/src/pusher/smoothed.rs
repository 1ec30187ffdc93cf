//! The pusher's track over a whole log: the fixed-interval smoother of a constant-velocity Kalman
//! filter, axis by axis ([`smoothed_track`]).

use std::ops::Range;

use stickslip_dynamics::Pose;
use stickslip_filter::{AxisEstimate, ConstantVelocity};

use crate::error::RunError;
use crate::pusher::jumps::accepted;
use crate::pusher::tracked_pose::{TrackedPose, bridged};
use crate::quantile::quantile;
use crate::setup::Camera;
use crate::tuning::{INITIAL_VELOCITY_STD, LARGER_NOISE_GAIN, TELLING_INTERVALS};

/// Larger noises that are tried, as multiples of the nominal one.
const LARGER: [f64; 7] = [2.0, 3.0, 4.5, 7.0, 10.0, 15.0, 25.0];

/// Tracks a finger by its `poses`, one per row; without a `camera` they count as exact.
pub(crate) fn smoothed_track(
    time: &[f64],
    poses: &[Option<Pose>],
    camera: Option<&Camera>,
) -> Result<Vec<Option<TrackedPose>>, RunError> {
    let seen = accepted(time, poses, camera);
    let mut rows = vec![None; time.len()];
    for span in spans(time, &seen) {
        let poses = track_span(&time[span.clone()], &seen[span.clone()], camera)?;
        for (row, pose) in rows[span].iter_mut().zip(poses) {
            *row = Some(pose);
        }
    }
    Ok(rows)
}

/// Row ranges in which the pusher is on the plane: from a first pose to the last before a gap that
/// is too long. A gap that runs to the end of the log is bridged like any other.
fn spans(time: &[f64], poses: &[Option<Pose>]) -> Vec<Range<usize>> {
    let seen: Vec<usize> = (0..poses.len())
        .filter(|&row| poses[row].is_some())
        .collect();
    let intervals = seen.windows(2).map(|pair| time[pair[1]] - time[pair[0]]);
    let intervals: Vec<f64> = intervals.collect();
    let interval = quantile(&intervals, 0.5).filter(|_| intervals.len() >= TELLING_INTERVALS);
    let bridged = |from: usize, to: usize| bridged(time[from], time[to], interval);
    let mut spans: Vec<Range<usize>> = Vec::new();
    for row in seen {
        match spans.last_mut() {
            Some(span) if bridged(span.end - 1, row) => span.end = row + 1,
            _ => spans.push(row..row + 1),
        }
    }
    for span in &mut spans {
        let last = span.end - 1;
        let held = (span.end..poses.len())
            .take_while(|&row| bridged(last, row))
            .count();
        if span.end + held == poses.len() {
            span.end += held;
        }
    }
    spans
}

fn track_span(
    time: &[f64],
    seen: &[Option<Pose>],
    camera: Option<&Camera>,
) -> Result<Vec<TrackedPose>, RunError> {
    let axis = |pick: fn(&Pose) -> f64, std: f64| {
        let measured: Vec<Option<f64>> = seen.iter().map(|pose| pose.as_ref().map(pick)).collect();
        track_axis(time, &measured, std)
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
        .map(|((x, y), theta)| TrackedPose::of([x, y, theta]));
    Ok(tracked.collect())
}

fn track_axis(
    time: &[f64],
    measured: &[Option<f64>],
    std: f64,
) -> Result<Vec<AxisEstimate>, RunError> {
    let too_few = measured.iter().flatten().count() < 3;
    if std == 0.0 || too_few {
        return Ok(bridge(time, measured));
    }
    let rows = fitted(time, measured, std)?.smooth(time, measured)?;
    Ok(rows.into_iter().flatten().collect())
}

/// Returns the model of greatest likelihood: with the nominal noise `std`, or with a larger one if
/// the poses clearly scatter by more.
fn fitted(time: &[f64], measured: &[Option<f64>], std: f64) -> Result<ConstantVelocity, RunError> {
    let fit = |measurement_std: f64| -> Result<(ConstantVelocity, f64), RunError> {
        let model = ConstantVelocity {
            process_noise: 0.0,
            measurement_std,
            initial_velocity_std: INITIAL_VELOCITY_STD,
        };
        let fit = model.fit_process_noise(time, measured)?;
        let process_noise = fit.process_noise;
        Ok((
            ConstantVelocity {
                process_noise,
                ..model
            },
            fit.log_likelihood,
        ))
    };
    let (mut best, stated) = fit(std)?;
    let mut most = stated + LARGER_NOISE_GAIN;
    for factor in LARGER {
        let (larger, log_likelihood) = fit(factor * std)?;
        if log_likelihood > most {
            (best, most) = (larger, log_likelihood);
        }
    }
    Ok(best)
}

/// Exact poses: gaps are interpolated, and held at the end. The first row is measured.
fn bridge(time: &[f64], measured: &[Option<f64>]) -> Vec<AxisEstimate> {
    let mut before = (time[0], measured[0].unwrap_or(0.0));
    let positions = (0..time.len()).map(|row| {
        if let Some(value) = measured[row] {
            before = (time[row], value);
            return value;
        }
        let after =
            (row..time.len()).find_map(|later| measured[later].map(|value| (time[later], value)));
        match after {
            Some((t, value)) => {
                before.1 + (value - before.1) * (time[row] - before.0) / (t - before.0)
            }
            None => before.1,
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
        covariance: 0.0,
    };
    (0..time.len()).map(at).collect()
}
