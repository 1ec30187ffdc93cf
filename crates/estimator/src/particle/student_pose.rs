//! Belief about a pose whose error is known as well as the noise of a camera is: [`StudentPose`].

use stickslip_dynamics::Pose;

/// Independent Student's t distributions of x, y (m) and θ (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudentPose {
    pub mean: Pose,
    /// Scale of each.
    pub scale: [f64; 3],
    /// Degrees of freedom of each; infinite for a normal distribution.
    pub freedom: [f64; 3],
}

impl StudentPose {
    /// Maps three numbers of the normal distribution to a pose at the same quantiles of these
    /// distributions. The pose is drawn from them if the numbers are random.
    pub fn at(&self, normals: [f64; 3]) -> Pose {
        let mut pose = self.mean;
        for (k, x) in pose.fields_mut().into_iter().enumerate() {
            *x += self.scale[k] * student(normals[k], self.freedom[k]);
        }
        pose
    }
}

/// Maps `z` of the normal distribution to the same quantile of Student's t distribution, to first
/// order in 1 / `freedom` (Fisher and Cornish 1960).
fn student(z: f64, freedom: f64) -> f64 {
    z + (z * z * z + z) / (4.0 * freedom)
}
