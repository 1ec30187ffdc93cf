//! Where an object rests that nothing has moved yet, by all that the camera has shown of it:
//! [`RestingPose`] (contact mode; docs/method.md (44)).

use stickslip_dynamics::{Lanes, Pose};

use crate::angle::wrapped;
use crate::particle::camera_likelihood::WRONG;
use crate::particle::camera_noise::{CameraNoise, MEMORY, NoisePrior};
use crate::setup::{Camera, Setup};

/// The belief about the pose of an object at rest, which is normal, axis by axis: the camera's poses
/// are all that is known of it, and no particle filter is needed to say what they add up to.
///
/// Particles that nothing has come near draw their pose anew from it, so that resampling cannot thin
/// them out while the object waits for the pusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingPose {
    /// Mean.
    pub(crate) mean: Pose,
    /// Variances of x and y (m²), and of θ (rad²).
    variance: [f64; 2],
    /// Number of the poses seen, each by how likely it is not wrong.
    poses: f64,
    /// Their mean.
    centre: Pose,
    /// Sums of the squares of their distances from it, in units of the told standard deviations.
    squares: [f64; 2],
    camera: Camera,
    /// What the camera's standard deviations are widened by.
    widened: f64,
    noise: Option<NoisePrior>,
}

impl RestingPose {
    /// Around `start`, as well as one camera pose tells.
    pub fn new(start: Pose, camera: &Camera, setup: &Setup) -> Self {
        Self {
            mean: start,
            variance: told(camera),
            poses: 0.0,
            centre: start,
            squares: [0.0; 2],
            camera: *camera,
            widened: setup.filter.likelihood_scale,
            noise: NoisePrior::new(setup.uncertainty.camera_noise),
        }
    }

    /// Begins again at `pose`.
    pub fn start_at(&mut self, pose: Pose) {
        *self = Self {
            mean: pose,
            variance: told(&self.camera),
            poses: 0.0,
            centre: pose,
            squares: [0.0; 2],
            ..*self
        };
    }

    /// Bayes' rule with one more pose of the camera, whose noise is what the poses before say. By as
    /// much as the pose may be wrong, it counts less.
    pub fn see(&mut self, pose: Pose) {
        let kept = 1.0 - 1.0 / MEMORY;
        let noise = self.noise_levels();
        let told = told(&self.camera).map(|variance| variance * self.widened * self.widened);
        let away = difference(&pose, &self.mean);
        let right = self.is_right(away, told, noise);

        // the pose
        let mean = self.mean.fields_mut().into_iter().zip(away.fields());
        for (axis, (mean, away)) in mean.enumerate() {
            let group = axis / 2;
            let prior = self.variance[group];
            *mean += prior * right / (prior * right + told[group] * noise[group]) * away;
        }
        for group in 0..2 {
            let (prior, measured) = (self.variance[group], told[group] * noise[group]);
            self.variance[group] = prior * measured / (prior * right + measured);
        }

        // the camera's noise
        let poses = kept * self.poses + right;
        let away = difference(&pose, &self.centre);
        let share = if poses > 0.0 { right / poses } else { 0.0 };
        let squares = self.squared(&away);
        for (sum, square) in self.squares.iter_mut().zip(squares) {
            *sum = kept * *sum + share * kept * self.poses * square;
        }
        for (centre, away) in self.centre.fields_mut().into_iter().zip(away.fields()) {
            *centre += share * away;
        }
        self.poses = poses;
    }

    /// A pose drawn from the belief, by three normal numbers.
    pub fn drawn(&self, [x, y, theta]: [f64; 3]) -> Pose {
        let [position, angle] = self.variance.map(f64::sqrt);
        Pose {
            x: self.mean.x + position * x,
            y: self.mean.y + position * y,
            theta: self.mean.theta + angle * theta,
        }
    }

    /// What a particle that has rested at `pose` all the time knows of the camera's noise: the number
    /// of the poses seen, and the sums of the squares of their distances from it.
    pub fn noise_seen_at(&self, pose: &Pose) -> [f64; 3] {
        let [position, angle] = self.squared(&difference(&self.centre, pose));
        let [squares, turns] = self.squares;
        let poses = self.poses;
        [poses, squares + poses * position, turns + poses * angle]
    }

    /// Variances of the camera's noise, in units of the told ones.
    fn noise_levels(&self) -> [f64; 2] {
        let Some(prior) = self.noise else {
            return [1.0; 2];
        };
        let [poses, position, angle] = self.noise_seen_at(&self.mean);
        prior.variances(poses, position, angle)
    }

    /// Probability that a pose so far from the mean is not wrong.
    fn is_right(&self, away: Pose, told: [f64; 2], noise: [f64; 2]) -> f64 {
        let squares = [away.x * away.x + away.y * away.y, away.theta * away.theta];
        let expected = [0, 1].map(|k| self.variance[k] / (told[k] * noise[k]) + 1.0);
        let [position, angle] = [0, 1].map(|k| squares[k] / (told[k] * expected[k]));
        let right = match self.noise {
            Some(prior) => {
                let seen = self.noise_seen_at(&self.mean).map(Lanes::splat);
                let noise = CameraNoise::of(seen);
                let [position, angle] = [position, angle].map(Lanes::splat);
                noise.log_likelihood(prior, position, angle).0[0]
            }
            None => -0.5 * (position + angle),
        };
        let right = libm::exp(right);
        right / (right + WRONG)
    }

    /// Squares of a difference of poses in units of the told standard deviations: of the position, of
    /// the angle.
    fn squared(&self, away: &Pose) -> [f64; 2] {
        let [position, angle] = told(&self.camera);
        let square = away.x * away.x + away.y * away.y;
        [square / position, away.theta * away.theta / angle]
    }
}

/// Variances of the camera as told.
fn told(camera: &Camera) -> [f64; 2] {
    [camera.position_std, camera.orientation_std].map(|std| std * std)
}

/// From `from` to `to`, θ on the circle.
fn difference(to: &Pose, from: &Pose) -> Pose {
    Pose {
        x: to.x - from.x,
        y: to.y - from.y,
        theta: wrapped(to.theta - from.theta),
    }
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    const CAMERA: Camera = Camera {
        position_std: 3e-4,
        orientation_std: 5e-3,
        latency: 0.0,
        pusher_position_std: 0.0,
        pusher_orientation_std: 0.0,
    };

    /// Before the first pose is seen; the camera's noise is as told.
    fn told_noise(start: Pose, widened: f64) -> RestingPose {
        RestingPose {
            mean: start,
            variance: told(&CAMERA),
            poses: 0.0,
            centre: start,
            squares: [0.0; 2],
            camera: CAMERA,
            widened,
            noise: None,
        }
    }

    /// Noisy poses of an object that rests at `at`.
    fn poses(at: Pose, count: u64, noise: f64) -> Vec<Pose> {
        let draw = |i| Streams::new(5).normals::<3>(i, 0, 0).map(|n| noise * n);
        let pose = |[x, y, theta]: [f64; 3]| Pose {
            x: at.x + CAMERA.position_std * x,
            y: at.y + CAMERA.position_std * y,
            theta: at.theta + CAMERA.orientation_std * theta,
        };
        (0..count).map(|i| pose(draw(i))).collect()
    }

    #[test]
    fn under_known_noise_it_is_least_squares_over_all_poses() {
        let (start, widened) = (Pose::new(0.1, -0.2, 3.1), 1.5);
        let seen = poses(Pose::new(0.1003, -0.2002, 3.102), 40, 1.0);
        let mut resting = told_noise(start, widened);
        seen.iter().for_each(|pose| resting.see(*pose));
        // the start with weight 1, every pose with that of its wider noise
        let weight = 1.0 / (widened * widened);
        let total = 1.0 + 40.0 * weight;
        let mean =
            |of: fn(&Pose) -> f64| (of(&start) + weight * seen.iter().map(of).sum::<f64>()) / total;
        let expected = [mean(|p| p.x), mean(|p| p.y), mean(|p| p.theta)];
        for (found, expected) in resting.mean.fields().into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7, "{found}, {expected}");
        }
        let variance = CAMERA.position_std * CAMERA.position_std / total;
        assert!((resting.variance[0] / variance - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_wrong_pose_and_a_turn_of_the_circle_move_nothing() {
        let start = Pose::new(0.0, 0.0, 3.1);
        let mut resting = told_noise(start, 1.0);
        let before = resting;
        resting.see(Pose::new(0.05, 0.0, 3.1));
        let moved = resting.mean.x - before.mean.x;
        assert!(moved.abs() < 1e-9, "{moved}");
        resting.see(Pose::new(0.0, 0.0, 3.1 - std::f64::consts::TAU));
        assert!((resting.mean.theta - 3.1).abs() < 1e-9);
    }

    /// The sums that a particle at any pose would have kept of the poses, one by one.
    #[test]
    fn what_a_particle_knows_of_the_noise_is_what_it_would_have_seen() {
        let at = Pose::new(0.02, 0.01, -0.3);
        let seen = poses(at, 60, 1.3);
        let mut resting = told_noise(at, 1.0);
        let particle = Pose::new(0.0203, 0.0099, -0.296);
        let (mut position, mut angle, mut count) = (0.0, 0.0, 0.0);
        let kept = 1.0 - 1.0 / MEMORY;
        for pose in &seen {
            resting.see(*pose);
            let (dx, dy) = (pose.x - particle.x, pose.y - particle.y);
            let turn = (pose.theta - particle.theta) / CAMERA.orientation_std;
            let std = CAMERA.position_std;
            position = kept * position + (dx * dx + dy * dy) / (std * std);
            angle = kept * angle + turn * turn;
            count = kept * count + 1.0;
        }
        let found = resting.noise_seen_at(&particle);
        for (found, expected) in found.into_iter().zip([count, position, angle]) {
            // poses far from the mean count a little less than 1
            assert!((found / expected - 1.0).abs() < 1e-3, "{found}, {expected}");
        }
    }
}
