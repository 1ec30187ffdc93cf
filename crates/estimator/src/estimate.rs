//! Estimates of a method, row by row: [`Estimate`] and [`EstimateRow`].

use stickslip_dynamics::{Friction, Pose, Twist};

use crate::belief_mode::BeliefMode;
use crate::contact_slip::ContactSlip;
use crate::covariance::PoseCovariance;

/// Uncertainty of an estimate row: standard deviations, and covariances of the pose's errors. For
/// the particle filter these are root mean square deviations from the row's pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Standard deviations of the pose (m, m, rad).
    pub pose: Pose,
    /// Off-diagonal covariances of the pose; `None` if they are not known.
    pub cross: Option<CrossCovariance>,
    /// Standard deviations of the friction parameters; `None` for methods that do not estimate
    /// them.
    pub friction: Option<Friction>,
}

/// Off-diagonal entries of the covariance of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossCovariance {
    /// Covariance of x and y (m²).
    pub x_y: f64,
    /// Covariance of x and θ (m rad).
    pub x_theta: f64,
    /// Covariance of y and θ (m rad).
    pub y_theta: f64,
}

impl Spread {
    /// Returns the covariance of the pose. Unknown off-diagonal entries count as 0.
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

    /// Adds independent errors of these standard deviations.
    pub(crate) fn add(&mut self, errors: Pose) {
        let errors = errors.fields().into_iter();
        for (std, error) in self.pose.fields_mut().into_iter().zip(errors) {
            *std = std.hypot(*error);
        }
    }

    /// Converts deviations about a mean to those about a pose that is `way` from it.
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
    /// Pose; theta is unwrapped from the row before. The robust model publishes the geometric
    /// median of the particles, docs/model.md (42), the paper's model their mean.
    pub pose: Option<Pose>,
    /// Twist.
    pub twist: Option<Twist>,
    /// Friction parameters. `d_tri` is ignored where the feet are known (see
    /// [`Estimate::has_tripod`]).
    pub friction: Option<Friction>,
    /// Posterior probability of contact with the pusher, or with the first finger of a hand.
    pub contact_pusher: Option<f64>,
    /// Posterior probability of contact with each fixel, then with each other finger of a hand.
    pub contact_others: Option<Vec<f64>>,
    /// Posterior probability that the object is held: its contacts resist forces and torques in all
    /// directions, if they press (frictional form closure). Bodies within
    /// [`touch_gap`](crate::Uncertainty::touch_gap) count.
    pub held: Option<f64>,
    /// Slip of the object on what it touches: on the pusher, then on each fixel, then on each other
    /// finger.
    pub slip: Option<Vec<ContactSlip>>,
    /// Standard deviations and covariances.
    pub spread: Option<Spread>,
    /// Effective sample size after weighing.
    pub ess: Option<f64>,
    /// True if the step to this row began with resampling.
    pub resampled: Option<bool>,
    /// Number of particles of the previous row that those of this row descend from.
    pub distinct: Option<u32>,
    /// Number of particles that those of this row descend from in the latest earlier row with a
    /// camera pose.
    pub ancestors: Option<u32>,
    /// True if no particle explained this row's camera pose, so that all were reinitialised around
    /// it.
    pub collapsed: Option<bool>,
    /// Modes of the belief, the likeliest first; none for methods without particles.
    pub modes: Vec<BeliefMode>,
    /// True if a camera pose was used.
    pub visual: bool,
    /// Number of particles whose step has no certified solution, including those that learn
    /// friction.
    pub unsolved: Option<u32>,
    /// Number of these whose solver gave up; for the others it proved that there is no solution.
    pub failed: Option<u32>,
}

/// Speed (m/s) and turn rate (rad/s) above either of which the object counts as moving. A jam ends
/// in a slower creep.
const MOVING: f64 = 1e-3;
const TURNING: f64 = 0.03;

impl EstimateRow {
    /// Returns true if the object moves faster than 1 mm/s or turns faster than 0.03 rad/s. Nothing
    /// is learned of friction while it rests.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.twist.as_ref().is_some_and(moves)
    }
}

/// Returns true if a twist is faster than 1 mm/s or turns faster than 0.03 rad/s.
pub(crate) fn moves(twist: &Twist) -> bool {
    twist.vx.hypot(twist.vy) > MOVING || twist.omega.abs() > TURNING
}

/// A method's estimates, one row per log row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Time of each row (s).
    pub time: Vec<f64>,
    /// Rows.
    pub rows: Vec<EstimateRow>,
    /// Number of bodies besides the object and the pusher's first finger: the fixels, then the
    /// other fingers.
    pub others: usize,
    /// True if d_tri is a parameter. It is false if the feet are known; its columns are then empty.
    pub has_tripod: bool,
}

impl Estimate {
    /// Returns the pose at `time` (s), linear between rows; `None` outside the estimated rows.
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Option<Pose> {
        let (before, after, share) = self.rows_about(time)?;
        match share {
            0.0 => before.pose,
            _ => Some(before.pose?.interpolate(after.pose?, share)),
        }
    }

    /// Returns the pose's standard deviations at `time` (s), variances linear between rows; `None`
    /// outside the estimated rows.
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

    /// Returns the rows before and after `time`, and its share of the way from one to the other.
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
