//! Noise of tracked poses, compared with the true ones: [`Noise`].

use serde::Serialize;
use stickslip::dynamics::Pose;
use stickslip::{Camera, Log};
use stickslip_formats::Truth;

/// Least error that is assumed of any tracked pose (m, rad): the bias that tracking may have,
/// docs/guide/camera.md. Frames have it in common, so that a filter must not average it away.
const BIAS: [f64; 2] = [5e-5, 0.05 * std::f64::consts::PI / 180.0];

/// Sums of squared errors of tracked poses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    object: SquaredErrors,
    pusher: SquaredErrors,
}

/// SquaredErrors of one body.
#[derive(Clone, Copy, Debug, Default)]
struct SquaredErrors {
    /// Sum over poses of x² + y² (m²).
    position: f64,
    /// Sum of θ² (rad²).
    angle: f64,
    poses: u32,
    frames: u32,
}

/// Root mean square errors.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct NoiseLevel {
    /// Of the object's position, per axis (mm).
    pub object_mm: f64,
    /// Of its angle (degrees).
    pub object_deg: f64,
    /// Of the pusher's position, per axis (mm).
    pub pusher_mm: f64,
    /// Of its angle (degrees).
    pub pusher_deg: f64,
    /// Share of frames that give the object's pose.
    pub seen: f64,
}

impl SquaredErrors {
    fn of(tracked: &[Option<Pose>], truth: &[Pose]) -> Self {
        let pairs = tracked.iter().zip(truth);
        let none = Self {
            frames: tracked.len() as u32,
            ..Self::default()
        };
        pairs
            .filter_map(|(tracked, truth)| Some(((*tracked)?, truth)))
            .fold(none, |sum, (tracked, truth)| {
                let turn = libm::remainder(tracked.theta - truth.theta, std::f64::consts::TAU);
                let [x, y] = [tracked.x - truth.x, tracked.y - truth.y];
                Self {
                    position: sum.position + x * x + y * y,
                    angle: sum.angle + turn * turn,
                    poses: sum.poses + 1,
                    ..sum
                }
            })
    }

    fn with(self, other: Self) -> Self {
        Self {
            position: self.position + other.position,
            angle: self.angle + other.angle,
            poses: self.poses + other.poses,
            frames: self.frames + other.frames,
        }
    }

    /// Root mean square per axis (m), and of the angle (rad).
    fn level(&self) -> [f64; 2] {
        let poses = f64::from(self.poses.max(1));
        [
            (self.position / (2.0 * poses)).sqrt(),
            (self.angle / poses).sqrt(),
        ]
    }
}

impl Noise {
    /// The errors of a log's poses; `truth` has a row for each of the log's.
    #[must_use]
    pub fn of(log: &Log, truth: &Truth) -> Self {
        Self {
            object: SquaredErrors::of(&log.object, &truth.pose),
            pusher: SquaredErrors::of(&log.pusher, &truth.pusher),
        }
    }

    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            object: self.object.with(other.object),
            pusher: self.pusher.with(other.pusher),
        }
    }

    /// A camera of this noise.
    #[must_use]
    pub fn camera(&self) -> Camera {
        let ([position_std, orientation_std], [pusher_position_std, pusher_orientation_std]) =
            (self.object.level(), self.pusher.level());
        Camera {
            position_std,
            orientation_std,
            latency: 0.0,
            pusher_position_std,
            pusher_orientation_std,
        }
    }

    /// The camera that the methods reckon with: no less noisy than tracking may be biased.
    #[must_use]
    pub fn given_camera(&self) -> Camera {
        let camera = self.camera();
        let [position, angle] = BIAS;
        Camera {
            position_std: camera.position_std.max(position),
            orientation_std: camera.orientation_std.max(angle),
            pusher_position_std: camera.pusher_position_std.max(position),
            pusher_orientation_std: camera.pusher_orientation_std.max(angle),
            ..camera
        }
    }

    /// For tables.
    #[must_use]
    pub fn level(&self) -> NoiseLevel {
        let camera = self.camera();
        NoiseLevel {
            object_mm: 1e3 * camera.position_std,
            object_deg: camera.orientation_std.to_degrees(),
            pusher_mm: 1e3 * camera.pusher_position_std,
            pusher_deg: camera.pusher_orientation_std.to_degrees(),
            seen: f64::from(self.object.poses) / f64::from(self.object.frames.max(1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_given_no_less_than_the_bias_of_tracking() {
        let given = Noise::default().given_camera();
        assert_eq!([given.position_std, given.pusher_position_std], [5e-5; 2]);
        assert_eq!(
            [given.orientation_std, given.pusher_orientation_std]
                .map(|std| (std.to_degrees() * 1e6).round()),
            [5e4; 2]
        );
    }

    #[test]
    fn noise_is_the_root_mean_square_of_poses_that_are_there() {
        let truth = Truth {
            time: vec![0.0, 1.0, 2.0],
            pose: vec![Pose::default(); 3],
            pusher: vec![Pose::new(1.0, 1.0, 3.1); 3],
            ..Truth::default()
        };
        let log = Log {
            time: truth.time.clone(),
            object: vec![
                Some(Pose::new(3e-3, 4e-3, 0.1)),
                None,
                Some(Pose::new(3e-3, -4e-3, -0.1)),
            ],
            pusher: vec![Some(Pose::new(1.0, 1.0, -3.1)); 3],
            ..Log::default()
        };
        let level = Noise::of(&log, &truth).level();
        assert!(
            (level.object_mm - 12.5_f64.sqrt()).abs() < 1e-9
                && (level.object_deg - 0.1_f64.to_degrees()).abs() < 1e-9,
            "{level:?}"
        );
        assert!(
            (level.pusher_deg - (std::f64::consts::TAU - 6.2).to_degrees()).abs() < 1e-9
                && level.pusher_mm == 0.0
        );
        assert!((level.seen - 2.0 / 3.0).abs() < 1e-12);
    }
}
