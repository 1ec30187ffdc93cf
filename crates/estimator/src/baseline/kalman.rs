//! The Kalman filter baseline: Newton's law with all contact forces as unknown disturbance, per
//! axis (docs/method.md (30)).
//!
//! Each of x, y, θ follows a white-noise acceleration. Its level is the one of greatest likelihood
//! on the visible part of the log, so that the baseline is a fair rival. The filter goes on at its
//! last velocity while the camera is off. Poses with a covariance of their own count with their own
//! variances, axis by axis.

use stickslip_dynamics::{Pose, Twist};
use stickslip_filter::{AxisEstimate, ConstantVelocity};

use crate::angle::unwrapped;
use crate::covariance::PoseCovariance;
use crate::error::RunError;
use crate::estimate::{CrossCovariance, Estimate, EstimateRow, Spread};
use crate::prepared_log::PreparedLog;
use crate::setup::{Camera, Setup};

/// Filters the visible object poses of `prepared`.
pub(crate) fn track(
    setup: &Setup,
    camera: &Camera,
    prepared: &PreparedLog<'_>,
) -> Result<Estimate, RunError> {
    let poses = unwrapped_poses(prepared);
    let axis = |axis: &Axis| track_axis(prepared, &poses, axis, camera.latency);
    let x = axis(&Axis {
        pick: |p| p.x,
        variance: |c| c.x,
        std: camera.position_std,
    })?;
    let y = axis(&Axis {
        pick: |p| p.y,
        variance: |c| c.y,
        std: camera.position_std,
    })?;
    let theta = axis(&Axis {
        pick: |p| p.theta,
        variance: |c| c.theta,
        std: camera.orientation_std,
    })?;
    let mut estimate = prepared.empty_estimate(setup);
    for row in prepared.first..prepared.log.len() {
        let (Some(x), Some(y), Some(theta)) = (x[row], y[row], theta[row]) else {
            continue;
        };
        estimate.rows[row] = EstimateRow {
            pose: Some(Pose::new(x.position, y.position, theta.position)),
            twist: Some(Twist {
                vx: x.velocity,
                vy: y.velocity,
                omega: theta.velocity,
            }),
            spread: Some(Spread {
                pose: Pose::new(
                    x.position_variance.sqrt(),
                    y.position_variance.sqrt(),
                    theta.position_variance.sqrt(),
                ),
                // the axes are filtered each by itself
                cross: Some(CrossCovariance::default()),
                friction: None,
            }),
            visual: prepared.visible(row).is_some(),
            ..EstimateRow::default()
        };
    }
    Ok(estimate)
}

/// Visible poses with θ unwrapped from one to the next.
fn unwrapped_poses(prepared: &PreparedLog<'_>) -> Vec<Option<Pose>> {
    let mut near = prepared.start.theta;
    let rows = (0..prepared.log.len()).map(|row| {
        let pose = prepared.visible(row)?;
        near = unwrapped(pose.theta, near);
        Some(Pose {
            theta: near,
            ..pose
        })
    });
    rows.collect()
}

/// One of x, y, θ.
struct Axis {
    /// Coordinate of a pose.
    pick: fn(&Pose) -> f64,
    /// Variance of the coordinate, by a pose's own covariance.
    variance: fn(&PoseCovariance) -> f64,
    /// Standard deviation of the coordinate of all other poses.
    std: f64,
}

fn track_axis(
    prepared: &PreparedLog<'_>,
    poses: &[Option<Pose>],
    axis: &Axis,
    latency: f64,
) -> Result<Vec<Option<AxisEstimate>>, RunError> {
    let &Axis {
        pick,
        variance,
        std,
    } = axis;
    let measured: Vec<Option<f64>> = poses.iter().map(|pose| pose.as_ref().map(pick)).collect();
    let own = |row| prepared.covariance(row).map(|c| variance(&c).sqrt());
    let stds: Vec<Option<f64>> = (0..poses.len()).map(own).collect();
    // with too few poses for a noise level, Newton's first law from rest
    let mut model = ConstantVelocity {
        process_noise: 1e-6,
        measurement_std: std,
        initial_velocity_std: 0.1,
    };
    let time = &prepared.log.time;
    if measured.iter().flatten().count() >= 3 {
        model.process_noise = model
            .fit_process_noise_with_stds(time, &measured, &stds)?
            .process_noise;
    } else {
        model.initial_velocity_std = 1e-9;
    }
    let rows = model.filter_with_stds(time, &measured, &stds)?.rows;
    // a pose in row k shows the object one latency earlier: the estimate of the present is
    // predicted from it
    Ok(rows
        .into_iter()
        .map(|row| row.map(|at| AxisEstimate::from(model.predict(&at.into(), latency))))
        .collect())
}
