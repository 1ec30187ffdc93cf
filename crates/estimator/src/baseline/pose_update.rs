//! Update of the extended Kalman filter by a camera pose: [`PoseUpdate`] (docs/method.md (48)).

use nalgebra::{SMatrix, SVector};
use stickslip_dynamics::Pose;

use crate::angle::unwrapped;
use crate::baseline::belief::{Belief, STATES, TWIST};
use crate::covariance::PoseCovariance;
use crate::setup::Camera;
use crate::tuning::ACCEPTED_AFTER;

/// Squared Mahalanobis distance of the innovation that one right pose in 10,000 exceeds: χ² of
/// three degrees of freedom.
const UNLIKELY: f64 = 21.108;

/// Covariance of x, y and θ (m, m, rad).
pub(super) type PoseNoise = SMatrix<f64, 3, 3>;

/// Update by poses that show the object one latency ago.
#[derive(Clone, Debug)]
pub(super) struct PoseUpdate {
    camera: Camera,
    /// The latest pose. A pose that equals it is the same frame again.
    shown: Pose,
    /// Number of unexpected poses in a row.
    unexpected: u32,
    /// Number of times that the belief has restarted.
    pub restarts: u32,
}

impl PoseUpdate {
    /// An update after a `first` pose.
    pub fn new(camera: Camera, first: Pose) -> Self {
        Self {
            camera,
            shown: first,
            unexpected: 0,
            restarts: 0,
        }
    }

    /// Returns the covariance of a measured pose: its `own`, or the camera's.
    pub fn noise(&self, own: Option<PoseCovariance>) -> PoseNoise {
        let square = |std: f64| std * std;
        let c = own.unwrap_or(PoseCovariance {
            x: square(self.camera.position_std),
            y: square(self.camera.position_std),
            theta: square(self.camera.orientation_std),
            ..PoseCovariance::default()
        });
        PoseNoise::new(
            c.x, c.x_y, c.x_theta, c.x_y, c.y, c.y_theta, c.x_theta, c.y_theta, c.theta,
        )
    }

    /// Updates `belief` by a pose; returns true if the pose was used.
    pub fn see(&mut self, belief: &mut Belief, pose: Pose, noise: &PoseNoise) -> bool {
        if pose == self.shown {
            return false;
        }
        self.shown = pose;
        let mut sensor = SMatrix::<f64, 3, STATES>::zeros();
        for k in 0..3 {
            sensor[(k, k)] = 1.0;
            sensor[(k, TWIST + k)] = -self.camera.latency;
        }
        let expected = sensor * belief.normal.mean;
        let theta = unwrapped(pose.theta, expected[2]);
        let measured = SVector::<f64, 3>::new(pose.x, pose.y, theta);
        let update = belief.normal.update(&measured, &sensor, noise);
        let update = update.filter(|update| {
            let innovation = &update.innovation;
            let scale = innovation.covariance.cholesky();
            scale.is_some_and(|s| innovation.mean.dot(&s.solve(&innovation.mean)) < UNLIKELY)
        });
        if let Some(update) = update {
            self.unexpected = 0;
            belief.normal = update.posterior;
            belief.limit_friction();
            return true;
        }
        self.unexpected += 1;
        let accepted = self.unexpected >= ACCEPTED_AFTER;
        if accepted {
            self.unexpected = 0;
            self.restarts += 1;
            belief.begin_anew(&measured, noise);
        }
        accepted
    }
}
