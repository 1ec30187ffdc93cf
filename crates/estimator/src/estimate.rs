//! What a method says of the object, row by row: [`Estimate`] and [`EstimateRow`].

use stickslip_dynamics::{Friction, Pose, Twist};

use crate::belief_mode::BeliefMode;
use crate::contact_slip::ContactSlip;
use crate::covariance::PoseCovariance;

/// How far from an estimate row the object may be: standard deviations, and how the errors of its
/// pose go together. Of the particle filter they are root mean square deviations from the row's
/// pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Standard deviations of the pose (m, m, rad).
    pub pose: Pose,
    /// Covariances of the pose's numbers; `None` where they are not known.
    pub cross: Option<CrossCovariance>,
    /// Standard deviations of the friction parameters; `None` for methods that do not estimate
    /// them.
    pub friction: Option<Friction>,
}

/// The covariance of a pose off its diagonal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossCovariance {
    /// Of x and y (m²).
    pub x_y: f64,
    /// Of x and θ (m rad).
    pub x_theta: f64,
    /// Of y and θ (m rad).
    pub y_theta: f64,
}

impl Spread {
    /// The covariance of the pose; what is not known off the diagonal counts as 0.
    #[must_use]
    pub fn covariance(&self) -> PoseCovariance {
        let CrossCovariance {
            x_y,
            x_theta,
            y_theta,
        } = self.cross.unwrap_or_default();
        let Pose { x, y, theta } = self.pose;
        PoseCovariance {
            x: x * x,
            y: y * y,
            theta: theta * theta,
            x_y,
            x_theta,
            y_theta,
        }
    }

    /// From deviations about a mean to those about a pose that is `way` from it.
    pub(crate) fn move_centre(&mut self, way: Pose) {
        let Pose { x, y, theta } = way;
        self.pose.x = self.pose.x.hypot(x);
        self.pose.y = self.pose.y.hypot(y);
        self.pose.theta = self.pose.theta.hypot(theta);
        if let Some(cross) = &mut self.cross {
            cross.x_y += x * y;
            cross.x_theta += x * theta;
            cross.y_theta += y * theta;
        }
    }
}

/// A method's estimate at one log row. `None` is an empty cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EstimateRow {
    /// Pose; theta is unwrapped from the row before. Of particles that of the least mean distance
    /// to them, docs/method.md (51); in paper mode their mean.
    pub pose: Option<Pose>,
    /// Twist.
    pub twist: Option<Twist>,
    /// Friction parameters, in contact mode as known when the camera last saw the object,
    /// docs/method.md (52); `d_tri` is NaN-free: it is ignored where the feet are known (see
    /// [`Estimate::has_tripod`]).
    pub friction: Option<Friction>,
    /// Posterior probability of contact with the pusher.
    pub contact_pusher: Option<f64>,
    /// Posterior probability of contact with each fixel.
    pub contact_fixels: Option<Vec<f64>>,
    /// How the object slips on what it touches: on the pusher, then on each fixel.
    pub slip: Option<Vec<ContactSlip>>,
    /// Standard deviations and covariances.
    pub spread: Option<Spread>,
    /// Effective sample size after weighing.
    pub ess: Option<f64>,
    /// Whether this step began with resampling.
    pub resampled: Option<bool>,
    /// Number of particles of the row before that those of this row descend from.
    pub distinct: Option<u32>,
    /// The same of the latest row before with a camera pose.
    pub ancestors: Option<u32>,
    /// Whether no particle explained this row's camera pose, so that all were drawn anew around it.
    pub collapsed: Option<bool>,
    /// The places where the object may be, the likeliest first; none for methods without particles.
    pub modes: Vec<BeliefMode>,
    /// Whether a camera pose was used.
    pub visual: bool,
    /// Number of particles whose step has no certified solution, those that learn friction among
    /// them.
    pub unsolved: Option<u32>,
    /// Of those, the ones whose solver gave up; for the others it proved that there is no solution.
    pub failed: Option<u32>,
}

/// Speed (m/s) and turn (rad/s) above either of which an object moves: a jam ends in a creep.
const MOVING: f64 = 1e-3;
const TURNING: f64 = 0.03;

impl EstimateRow {
    /// Whether the object moves, faster than 1 mm/s or 0.03 rad/s: where it rests, nothing is
    /// learned of friction.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.twist
            .is_some_and(|v| v.vx.hypot(v.vy) > MOVING || v.omega.abs() > TURNING)
    }

    /// Whether a contact with pusher or fixel is possible at all.
    pub(crate) fn any_contact(&self) -> bool {
        let fixels = self.contact_fixels.iter().flatten();
        fixels.chain(&self.contact_pusher).any(|share| *share > 0.0)
    }
}

/// A method's estimates, one row per log row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Time of each row (s).
    pub time: Vec<f64>,
    /// Rows.
    pub rows: Vec<EstimateRow>,
    /// Number of fixels.
    pub fixels: usize,
    /// Whether d_tri is a parameter (false where the feet are known; its columns are then empty).
    pub has_tripod: bool,
}

impl Estimate {
    /// The pose at `time` (s), linear between rows; `None` outside the estimated rows.
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Option<Pose> {
        let (before, after, share) = self.rows_about(time)?;
        match share {
            0.0 => before.pose,
            _ => Some(before.pose?.interpolate(after.pose?, share)),
        }
    }

    /// The pose's standard deviations at `time` (s), variances linear between rows; `None` outside
    /// the estimated rows.
    #[must_use]
    pub fn std_at(&self, time: f64) -> Option<Pose> {
        let (before, after, share) = self.rows_about(time)?;
        let (mut std, after) = (before.spread?.pose, after.spread?.pose);
        if share > 0.0 {
            for (std, after) in std.fields_mut().into_iter().zip(after.fields()) {
                *std = ((1.0 - share) * *std * *std + share * after * after).sqrt();
            }
        }
        Some(std)
    }

    /// The rows before and after `time`, and how far it is from the one to the other.
    fn rows_about(&self, time: f64) -> Option<(&EstimateRow, &EstimateRow, f64)> {
        let later = self.time.partition_point(|t| *t < time);
        let after = self.rows.get(later)?;
        if self.time[later] == time {
            return Some((after, after, 0.0));
        }
        let (t0, t1) = (self.time[later.checked_sub(1)?], self.time[later]);
        Some((&self.rows[later - 1], after, (time - t0) / (t1 - t0)))
    }
}
