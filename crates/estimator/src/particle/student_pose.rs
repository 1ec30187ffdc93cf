//! A belief about a pose whose error is known as well as the noise of a camera is: [`StudentPose`].

use stickslip_dynamics::Pose;

/// Independent Student's t distributions of x, y (m) and θ (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudentPose {
    pub mean: Pose,
    /// The scale of each.
    pub scale: [f64; 3],
    /// The degrees of freedom of each; infinite where it is normal.
    pub freedom: [f64; 3],
}

impl StudentPose {
    /// The pose that stands in these distributions where three numbers stand in the normal one;
    /// drawn from them where the numbers are random.
    pub fn at(&self, normals: [f64; 3]) -> Pose {
        let mut pose = self.mean;
        for (k, x) in pose.fields_mut().into_iter().enumerate() {
            *x += self.scale[k] * student(normals[k], self.freedom[k]);
        }
        pose
    }
}

/// The number of Student's t distribution that stands where `z` stands in the normal one, to first
/// order in 1 / `freedom` (Fisher and Cornish 1960).
fn student(z: f64, freedom: f64) -> f64 {
    z + (z * z * z + z) / (4.0 * freedom)
}
