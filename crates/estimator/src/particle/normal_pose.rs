//! A normal belief about a pose, axis by axis: [`NormalPose`].

use stickslip_dynamics::Pose;

use crate::angle::difference;

/// Independent normal distributions of x, y (m) and θ (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalPose {
    pub mean: Pose,
    /// The variance of each.
    pub variance: [f64; 3],
}

impl NormalPose {
    /// Returns ln of the likelihood of a measured pose with these variances of its noise, relative
    /// to a perfect one.
    pub fn log_density(&self, pose: &Pose, noise: [f64; 3]) -> f64 {
        let away = difference(pose, &self.mean);
        let axes = away.fields().into_iter().enumerate();
        let parts = axes.map(|(k, away)| {
            let variance = self.variance[k] + noise[k];
            away * away / variance + libm::log(variance / noise[k])
        });
        -0.5 * parts.sum::<f64>()
    }
}
