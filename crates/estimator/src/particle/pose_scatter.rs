//! Scatter of the camera's poses of an object at rest: [`PoseScatter`] (docs/method.md (41), (44)).

use stickslip_dynamics::Pose;

use crate::angle::difference;
use crate::particle::camera_noise::MEMORY;

/// Group of each axis: position or angle.
pub const GROUP: [usize; 3] = [0, 0, 1];

/// Sums over the poses seen; old poses are forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseScatter {
    /// Number of poses, each by how likely it is not wrong.
    poses: f64,
    /// Sums of their nominal precisions, axis by axis.
    precision: [f64; 3],
    /// Mean of the poses, each by its precision.
    centre: Pose,
    /// Sums of the squares of their distances from the mean, in nominal standard deviations: of the
    /// position, of the angle.
    squares: [f64; 2],
}

impl PoseScatter {
    /// The scatter of a first pose, with its nominal variances of x, y (m²) and θ (rad²).
    pub fn of(pose: Pose, told: [f64; 3]) -> Self {
        Self {
            poses: 1.0,
            precision: told.map(f64::recip),
            centre: pose,
            squares: [0.0; 2],
        }
    }

    /// Takes one more pose with its nominal variances; `right` is the probability that it is not
    /// wrong.
    pub fn see(&mut self, pose: &Pose, told: [f64; 3], right: f64) {
        let kept = 1.0 - 1.0 / MEMORY;
        self.poses = kept * self.poses + right;
        self.squares = self.squares.map(|sum| kept * sum);
        let away = difference(pose, &self.centre);
        let centre = self.centre.fields_mut().into_iter().zip(away.fields());
        for (k, (centre, away)) in centre.enumerate() {
            let (before, new) = (kept * self.precision[k], right / told[k]);
            self.precision[k] = before + new;
            if new > 0.0 {
                self.squares[GROUP[k]] += before * new / (before + new) * away * away;
                *centre += new / (before + new) * away;
            }
        }
    }

    /// Returns the number of the poses, and the sums of the squares of their distances from `pose`,
    /// of position and angle.
    pub fn about(&self, pose: &Pose) -> [f64; 3] {
        let away = difference(&self.centre, pose);
        let [mut position, mut angle] = self.squares;
        position += self.precision[0] * away.x * away.x + self.precision[1] * away.y * away.y;
        angle += self.precision[2] * away.theta * away.theta;
        [self.poses, position, angle]
    }
}
