//! Motion of an object without known contacts, moved by a hand or an unseen pusher: [`FreeMotion`]
//! (robust model; docs/method.md (54)).

use stickslip_dynamics::Pose;
use stickslip_filter::{ConstantVelocity, Gaussian};

use crate::angle::difference;
use crate::particle::camera_likelihood::WRONG;
use crate::particle::normal_pose::NormalPose;

/// Probability that an object at rest is moved from one camera pose to the next, and that of an
/// object which has just been moved a little.
const STARTS: f64 = 1e-8;
const STARTS_AGAIN: f64 = 1e-2;

/// Mean duration of the motion (s).
const LASTS: f64 = 0.3;

/// Standard deviation of its speed (m/s), and time for which it keeps it (s).
const SPEED: f64 = 0.05;
const SPEED_LASTS: f64 = 1.0;

/// Belief that the object moves at nearly constant velocity. It competes with the belief that the
/// object rests: two models that interact (Blom & Bar-Shalom 1988), of which the likelier one is
/// reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeMotion {
    /// Position and velocity of x, y and θ; θ is unwrapped like that of `rest`.
    axes: [Gaussian<2>; 3],
    /// ln of the odds that it moves.
    log_odds: f64,
    /// The object's radius of gyration (m).
    radius: f64,
}

impl FreeMotion {
    /// An object that rests at `start`.
    pub fn new(start: &NormalPose, radius: f64) -> Self {
        Self {
            axes: starting_from(start, radius),
            log_odds: f64::NEG_INFINITY,
            radius,
        }
    }

    /// The belief about the same object, at rest at `start`.
    pub fn at_rest(self, start: &NormalPose) -> Self {
        Self::new(start, self.radius)
    }

    /// Returns true if it moves, more likely than not.
    pub fn moves(&self) -> bool {
        self.log_odds > 0.0
    }

    /// Returns where it is after a time `h` (s) in which it goes on.
    pub fn after(&self, h: f64) -> NormalPose {
        let mut pose = NormalPose {
            mean: Pose::default(),
            variance: [0.0; 3],
        };
        let axes = self.axes.iter().enumerate();
        for ((k, axis), mean) in axes.zip(pose.mean.fields_mut()) {
            let then = model(k, self.radius, 1.0).predict(axis, h);
            (*mean, pose.variance[k]) = (then.mean[0], then.covariance[(0, 0)]);
        }
        pose
    }

    /// Returns where it rests, if it may have stopped after `h` (s): the mixture of `rest`, where
    /// it was if it did not move, and of where it moved.
    pub fn stopped(&self, rest: &NormalPose, h: f64) -> NormalPose {
        let moves = self.probability();
        let (from_rest, from_motion) = (1.0 - moves, moves * (1.0 - libm::exp(-h / LASTS)));
        // nothing has stopped at the time of the pose before
        let share = from_motion / (from_rest + from_motion).max(f64::MIN_POSITIVE);
        let mut stopped = *rest;
        let axes = stopped
            .mean
            .fields_mut()
            .into_iter()
            .zip(self.with(rest, 1.0 - share));
        for (k, (mean, axis)) in axes.enumerate() {
            (*mean, stopped.variance[k]) = (axis.mean[0], axis.covariance[(0, 0)]);
        }
        stopped
    }

    /// Applies Bayes' rule with a camera pose, `h` (s) after the one before. `noise` are its
    /// variances. `rest` is where the object is if it rests, and `was_moved` is true if it has just
    /// been moved a little.
    pub fn see(
        &mut self,
        h: f64,
        (pose, noise): (&Pose, [f64; 3]),
        (rest, was_moved): (&NormalPose, bool),
    ) {
        // it goes on, or starts
        let start = if was_moved { STARTS_AGAIN } else { STARTS };
        let moves = self.probability();
        let stays = libm::exp(-h / LASTS);
        let (goes_on, starts) = (moves * stays, (1.0 - moves) * start);
        let (now_moves, now_rests) = (
            goes_on + starts,
            (1.0 - moves) * (1.0 - start) + moves * (1.0 - stays),
        );
        let now = self.with(rest, starts / now_moves);
        self.axes = std::array::from_fn(|k| model(k, self.radius, 1.0).predict(&now[k], h));

        // the odds, by which of the two the pose is likelier
        let moving = self.after(0.0);
        let likely = |by: &NormalPose| WRONG + libm::exp(by.log_density(pose, noise));
        let (if_moves, if_rests) = (likely(&moving), likely(rest));
        self.log_odds = libm::log(now_moves * if_moves) - libm::log(now_rests * if_rests);

        // where it is if it moves; the pose counts less, the likelier it is wrong
        let right = (1.0 - WRONG / if_moves).max(WRONG);
        let away = difference(pose, &moving.mean);
        for (k, away) in away.fields().into_iter().enumerate() {
            let std = (noise[k] / right).sqrt();
            let measured = self.axes[k].mean[0] + away;
            self.axes[k] = model(k, self.radius, std).update(&self.axes[k], measured).0;
        }
    }

    /// Returns the mixture of where it moves and, with this share, of one that starts from `rest`,
    /// axis by axis.
    fn with(&self, rest: &NormalPose, share: f64) -> [Gaussian<2>; 3] {
        let starts = starting_from(rest, self.radius);
        std::array::from_fn(|k| {
            Gaussian::mixture(&[(1.0 - share, self.axes[k]), (share, starts[k])], 1.0)
        })
    }

    /// Returns the probability that it moves.
    fn probability(&self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.log_odds))
    }
}

/// Returns the axes of an object at rest that is moved from now on.
fn starting_from(rest: &NormalPose, radius: f64) -> [Gaussian<2>; 3] {
    let means = rest.mean.fields();
    std::array::from_fn(|k| model(k, radius, rest.variance[k].sqrt()).start(*means[k]))
}

/// Model of the motion of axis `k`, measured with this standard deviation.
fn model(k: usize, radius: f64, measurement_std: f64) -> ConstantVelocity {
    let speed = if k < 2 { SPEED } else { SPEED / radius };
    ConstantVelocity {
        process_noise: 2.0 * speed * speed / SPEED_LASTS,
        measurement_std,
        initial_velocity_std: speed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: [f64; 3] = [9e-8, 9e-8, 2.5e-5];

    fn at(x: f64) -> NormalPose {
        NormalPose {
            mean: Pose::new(x, 0.0, 3.1),
            variance: NOISE.map(|variance| 0.1 * variance),
        }
    }

    #[test]
    fn poses_that_move_on_are_taken_for_motion_within_three_and_two_at_rest_for_rest() {
        let (mut free, mut rest) = (FreeMotion::new(&at(0.0), 0.02), at(0.0));
        let mut moved = Vec::new();
        // 60 mm/s at 30 Hz, from the third pose to the ninth, with half a turn of the circle in
        // between
        for k in 0..20 {
            let x = 2e-3 * (f64::from(k) - 2.0).clamp(0.0, 7.0);
            let turned = std::f64::consts::TAU * f64::from(k % 2);
            if free.moves() {
                rest = free.stopped(&rest, 1.0 / 30.0);
            }
            let pose = Pose::new(x, 0.0, 3.1 - turned);
            free.see(1.0 / 30.0, (&pose, NOISE), (&rest, false));
            moved.push(free.moves());
        }
        assert!(!moved[..3].contains(&true), "{moved:?}");
        assert!(!moved[5..10].contains(&false), "{moved:?}");
        assert!(!moved[12..].contains(&true), "{moved:?}");
        let followed = free.after(0.0).mean;
        assert!((followed.x - 0.014).abs() < 3e-4, "{followed:?}");
        assert!((followed.theta - 3.1).abs() < 1e-6, "{followed:?}");
    }

    #[test]
    fn poses_of_one_time_leave_numbers() {
        let (mut free, mut rest) = (FreeMotion::new(&at(0.0), 0.02), at(0.0));
        for k in 0..200 {
            let h = if k < 20 { 0.02 } else { 0.0 };
            let pose = Pose::new(2e-3 * f64::from(k.min(20)), 0.0, 3.1);
            if free.moves() {
                rest = free.stopped(&rest, h);
            }
            free.see(h, (&pose, NOISE), (&rest, false));
            let after = free.after(0.1);
            assert!(after.variance.iter().all(|v| *v > 0.0 && v.is_finite()));
            assert!(rest.mean.x.is_finite() && after.mean.x.is_finite(), "{k}");
        }
        assert!(free.moves());
    }
}
