//! Place of an object that nothing has moved yet, from all that the camera has shown of it:
//! [`RestingPose`] (robust model; docs/method.md (44)).

use stickslip_dynamics::{Lanes, Pose};

use crate::angle::difference;
use crate::covariance::PoseCovariance;
use crate::particle::aside::Aside;
use crate::particle::camera_likelihood::WRONG;
use crate::particle::camera_noise::{CameraNoise, MEMORY, NoisePrior};
use crate::particle::free_motion::FreeMotion;
use crate::particle::normal_pose::NormalPose;
use crate::particle::pose_scatter::{GROUP, PoseScatter};
use crate::particle::student_pose::StudentPose;
use crate::setup::{Camera, Setup};

/// Belief about the pose of an object at rest, axis by axis. The camera's poses are all that is
/// known of it, so they can be combined without a particle filter. The first of them is as noisy as
/// the others. Their noise is learned from all of them, so the belief is Student's t.
///
/// Particles that nothing has come near redraw their pose from it, so resampling cannot deplete
/// them while the object waits for the pusher. If the poses show that the object moves all the
/// same, as one that is set down by hand, they draw it from its [`FreeMotion`]. If many poses in a
/// row lie to one side, the object has been moved a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestingPose {
    mean: Pose,
    /// Variances of x, y (m²) and θ (rad²) under the camera's nominal noise.
    variance: [f64; 3],
    /// Scatter of the poses seen.
    scatter: PoseScatter,
    camera: Camera,
    /// Factor that widens the camera's standard deviations.
    widened: f64,
    /// Prior of its noise.
    noise: Option<NoisePrior>,
    /// Belief that it moves; `None` once something has touched it.
    free: Option<FreeMotion>,
    /// Time of the latest pose (s).
    time: f64,
    /// Displacement of the latest poses to one side.
    aside: Aside,
}

impl RestingPose {
    /// A belief around a pose seen at a `time` (s), as precise as that pose.
    pub fn new(
        time: f64,
        start: (Pose, Option<PoseCovariance>),
        camera: &Camera,
        setup: &Setup,
    ) -> Self {
        let told = NormalPose {
            mean: start.0,
            variance: [1.0; 3],
        };
        let unset = Self {
            free: Some(FreeMotion::new(&told, setup.scene.object.gyration_radius())),
            time,
            aside: Aside::default(),
            mean: start.0,
            variance: [0.0; 3],
            scatter: PoseScatter::of(start.0, [1.0; 3]),
            camera: *camera,
            widened: setup.filter.likelihood_scale,
            noise: NoisePrior::new(setup.uncertainty.camera_noise),
        };
        unset.started_at(start)
    }

    /// The belief before anything but `start` is seen.
    pub fn started_at(self, (start, covariance): (Pose, Option<PoseCovariance>)) -> Self {
        let told = self.told(covariance);
        let pose = NormalPose {
            mean: start,
            variance: told,
        };
        Self {
            free: self.free.map(|free| free.at_rest(&pose)),
            ..self.resting_at(&pose, told)
        }
    }

    /// The belief about another place, from poses with the variances `told`.
    fn resting_at(self, pose: &NormalPose, told: [f64; 3]) -> Self {
        Self {
            mean: pose.mean,
            variance: pose.variance,
            scatter: PoseScatter::of(pose.mean, told),
            aside: Aside::default(),
            ..self
        }
    }

    /// Notes that something touches the object: from now on the particles estimate whether it
    /// moves.
    pub fn touch(&mut self) {
        self.free = None;
    }

    /// Applies Bayes' rule with one more camera pose, at a `time` (s). The pose counts less, the
    /// likelier it is wrong.
    pub fn see(&mut self, time: f64, (pose, covariance): (Pose, Option<PoseCovariance>)) {
        let told = self.told(covariance);
        let measured = self.noise_of(covariance);

        // it may move
        let h = (time - self.time).max(0.0);
        self.time = self.time.max(time);
        if let Some(free) = self.free.filter(FreeMotion::moves) {
            let here = NormalPose {
                mean: self.mean,
                variance: self.variance,
            };
            *self = self.resting_at(&free.stopped(&here, h), told);
        }
        let (levels, _) = self.noise_levels();
        let rest = NormalPose {
            mean: self.mean,
            variance: std::array::from_fn(|k| self.variance[k] * levels[GROUP[k]]),
        };
        let was_moved = self.aside.is_no_chance();
        if let Some(free) = &mut self.free {
            let noise = std::array::from_fn(|k| measured[k] * levels[GROUP[k]]);
            free.see(h, (&pose, noise), (&rest, was_moved));
        }

        // the pose
        let right = self.is_right(&pose, told, measured);
        let away = difference(&pose, &self.mean);
        if self.free.is_some() {
            self.widen_where_moved((&away, right), measured, levels);
        }
        let mean = self.mean.fields_mut().into_iter().zip(away.fields());
        for (k, (mean, away)) in mean.enumerate() {
            let evidence = self.variance[k] * right + measured[k];
            *mean += self.variance[k] * right / evidence * away;
            let after = self.variance[k] * measured[k] / evidence;
            // old poses are forgotten as fast as those of the camera's noise
            let least = self.variance[k].min(measured[k] / MEMORY);
            self.variance[k] = after.max(least);
        }

        self.scatter.see(&pose, told, right);
    }

    /// Widens the belief if the latest poses lie to one side by more than chance: the object has
    /// been moved, so its place is not known better than that.
    fn widen_where_moved(
        &mut self,
        (away, right): (&Pose, f64),
        measured: [f64; 3],
        levels: [f64; 2],
    ) {
        let away = away.fields();
        self.aside.take(std::array::from_fn(|k| {
            let expected = (self.variance[k] + measured[k]) * levels[GROUP[k]];
            right * away[k] / expected.sqrt()
        }));
        if self.aside.is_no_chance() {
            let moved = self.aside.squares();
            for k in 0..3 {
                self.variance[k] = self.variance[k].max(moved[k] * measured[k]);
            }
        }
    }

    /// Returns true if the object waits no longer: something has touched it, or poses show that it
    /// moves.
    pub fn waits_no_longer(&self) -> bool {
        self.free.as_ref().is_none_or(FreeMotion::moves)
    }

    /// Returns the combined belief of all poses seen about where the object is after `h` (s).
    pub fn belief(&self, h: f64) -> StudentPose {
        if let Some(free) = self.free.filter(FreeMotion::moves) {
            let NormalPose { mean, variance } = free.after(h);
            return StudentPose {
                mean,
                scale: variance.map(f64::sqrt),
                freedom: [f64::INFINITY; 3],
            };
        }
        let (levels, freedoms) = self.noise_levels();
        StudentPose {
            mean: self.mean,
            scale: std::array::from_fn(|k| (self.variance[k] * levels[GROUP[k]]).sqrt()),
            freedom: GROUP.map(|group| freedoms[group]),
        }
    }

    /// Returns the knowledge of the camera's noise of a particle that has rested at `pose` all the
    /// time: the number of the poses seen, and the sums of the squares of their distances from it.
    pub fn noise_seen_at(&self, pose: &Pose) -> [f64; 3] {
        self.scatter.about(pose)
    }

    /// Returns the variances by which a pose counts, of x, y (m²) and θ (rad²).
    pub fn noise_of(&self, covariance: Option<PoseCovariance>) -> [f64; 3] {
        let wide = self.widened * self.widened;
        self.told(covariance).map(|variance| variance * wide)
    }

    /// Returns the variances of x, y and θ of a pose, its own or the camera's nominal ones.
    fn told(&self, covariance: Option<PoseCovariance>) -> [f64; 3] {
        match covariance {
            Some(of) => [of.x, of.y, of.theta],
            None => {
                let Camera {
                    position_std,
                    orientation_std,
                    ..
                } = self.camera;
                [position_std, position_std, orientation_std].map(|std| std * std)
            }
        }
    }

    /// Returns the variances of the camera's noise, in units of the nominal ones, of positions and
    /// of angles, and their degrees of freedom. One pose was needed to know where the object is.
    fn noise_levels(&self) -> ([f64; 2], [f64; 2]) {
        let Some(prior) = self.noise else {
            return ([1.0; 2], [f64::INFINITY; 2]);
        };
        let [poses, position, angle] = self.noise_seen_at(&self.mean);
        let others = (poses - 1.0).max(0.0);
        (
            prior.variances(others, position, angle),
            prior.freedoms(others),
        )
    }

    /// Returns the probability that a pose is not wrong, by its distance from the mean; `measured`
    /// are its variances.
    fn is_right(&self, pose: &Pose, told: [f64; 3], measured: [f64; 3]) -> f64 {
        let away = difference(pose, &self.mean);
        let wide = self.widened * self.widened;
        let mut squares = [0.0; 2];
        for (k, away) in away.fields().into_iter().enumerate() {
            // the pose may be away by as much as the mean is unknown
            let unknown = 1.0 + self.variance[k] / measured[k];
            squares[GROUP[k]] += away * away / (told[k] * wide * unknown);
        }
        let [position, angle] = squares;
        let right = match self.noise {
            Some(prior) => {
                let seen = self.noise_seen_at(&self.mean).map(Lanes::splat);
                let [position, angle] = squares.map(Lanes::splat);
                CameraNoise::of(seen)
                    .log_likelihood(prior, position, angle)
                    .0[0]
            }
            None => -0.5 * (position + angle),
        };
        let right = libm::exp(right);
        right / (right + WRONG)
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

    /// A belief before the first pose is seen; the camera has its nominal noise.
    fn told_noise(start: Pose, widened: f64) -> RestingPose {
        let unset = RestingPose {
            mean: start,
            variance: [0.0; 3],
            scatter: PoseScatter::of(start, [1.0; 3]),
            camera: CAMERA,
            widened,
            noise: None,
            free: Some(FreeMotion::new(
                &NormalPose {
                    mean: start,
                    variance: [1.0; 3],
                },
                0.02,
            )),
            time: 0.0,
            aside: Aside::default(),
        };
        unset.started_at((start, None))
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
        seen.iter().for_each(|pose| resting.see(0.0, (*pose, None)));
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

    /// An object is nudged by a few standard deviations, none of which makes a pose wrong.
    #[test]
    fn where_it_was_long_ago_is_forgotten() {
        let mut resting = told_noise(Pose::default(), 1.0);
        let nudged = Pose::new(1e-3, 0.0, 0.0);
        for pose in poses(Pose::default(), 3000, 1.0) {
            resting.see(0.0, (pose, None));
        }
        let known = resting.variance[0].sqrt() / CAMERA.position_std;
        assert!((known * MEMORY.sqrt() - 1.0).abs() < 0.01, "{known}");
        for pose in poses(nudged, 1500, 1.0) {
            resting.see(0.0, (pose, None));
        }
        // e^-5 of the way is left, and noise
        let left = (resting.mean.x - nudged.x).abs();
        assert!(left < 7e-6 + 4.0 * known * CAMERA.position_std, "{left}");
    }

    #[test]
    fn a_wrong_pose_and_a_turn_of_the_circle_move_nothing() {
        let start = Pose::new(0.0, 0.0, 3.1);
        let mut resting = told_noise(start, 1.0);
        let before = resting;
        resting.see(0.0, (Pose::new(0.05, 0.0, 3.1), None));
        let moved = resting.mean.x - before.mean.x;
        assert!(moved.abs() < 1e-9, "{moved}");
        resting.see(
            0.0,
            (Pose::new(0.0, 0.0, 3.1 - std::f64::consts::TAU), None),
        );
        assert!((resting.mean.theta - 3.1).abs() < 1e-9);
    }

    /// Sums that a particle at any pose would have kept of the poses, one by one.
    #[test]
    fn what_a_particle_knows_of_the_noise_is_what_it_would_have_seen() {
        let at = Pose::new(0.02, 0.01, -0.3);
        let seen = poses(at, 60, 1.3);
        let mut resting = told_noise(at, 1.0);
        let particle = Pose::new(0.0203, 0.0099, -0.296);
        let (mut position, mut angle, mut count) = (0.0, 0.0, 0.0);
        let kept = 1.0 - 1.0 / MEMORY;
        seen.iter().for_each(|pose| resting.see(0.0, (*pose, None)));
        for pose in std::iter::once(&at).chain(&seen) {
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

    /// Poses of objects under cameras whose noise is drawn from the prior, that of the first one,
    /// too.
    #[test]
    fn under_unknown_noise_intervals_hold_what_they_say() {
        let noise = NoisePrior::new(0.4);
        let prior = noise.unwrap();
        let truths = 4000;
        let mut held = [0_u32; 3];
        for truth in 0..truths {
            let draw = Streams::new(7).at(truth);
            let levels = [0, 1].map(|sensor| prior.drawn(draw, sensor).sqrt());
            let seen = |i| {
                let normals = Streams::new(truth).normals::<3>(i, 0, 0);
                let noise = |k: usize, std| levels[GROUP[k]] * std * normals[k];
                let (position, angle) = (CAMERA.position_std, CAMERA.orientation_std);
                Pose::new(noise(0, position), noise(1, position), noise(2, angle))
            };
            let mut resting = told_noise(seen(0), 1.0);
            resting.noise = noise;
            (1..20).for_each(|i| resting.see(0.0, (seen(i), None)));
            let [low, high] = [-1.645, 1.645].map(|z| resting.belief(0.0).at([z; 3]));
            for ((held, low), high) in held.iter_mut().zip(low.fields()).zip(high.fields()) {
                *held += u32::from((*low..=*high).contains(&0.0));
            }
        }
        // 90 %, within four standard errors
        for held in held {
            let share = f64::from(held) / truths as f64;
            assert!((share - 0.9).abs() < 0.019, "{share}");
        }
    }

    /// A pose counts by its own standard deviations if it has some.
    #[test]
    fn poses_count_by_their_own_covariance() {
        let covariance = PoseCovariance {
            x: 1e-8,
            y: 4e-8,
            theta: 1e-6,
            ..PoseCovariance::default()
        };
        let mut resting = told_noise(Pose::default(), 1.0);
        let seen = Pose::new(2e-4, -3e-4, 2e-3);
        resting.see(0.0, (seen, Some(covariance)));
        let prior = [
            CAMERA.position_std,
            CAMERA.position_std,
            CAMERA.orientation_std,
        ];
        let own = [covariance.x, covariance.y, covariance.theta];
        let seen = seen.fields();
        for (k, found) in resting.mean.fields().into_iter().enumerate() {
            let prior = prior[k] * prior[k];
            let expected = seen[k] * prior / (prior + own[k]);
            assert!((found / expected - 1.0).abs() < 1e-5, "{found}, {expected}");
        }
    }
}
