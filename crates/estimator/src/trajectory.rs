//! Known motion of the object between given instants: [`Trajectory`].

use stickslip_dynamics::Pose;

/// Largest difference of two times that is only rounding in a file (s).
const SAME_TIME: f64 = 1e-4;

/// Poses at rising times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trajectory<'a> {
    /// Times (s), strictly rising.
    pub time: &'a [f64],
    /// Pose at each time.
    pub pose: &'a [Pose],
}

impl Trajectory<'_> {
    /// Returns the pose at `time` (s), linear between instants. The pose of an instant within 0.1
    /// ms is returned as it is. Returns `None` outside the instants.
    ///
    /// ```
    /// # use stickslip::{Trajectory, dynamics::Pose};
    /// let known = Trajectory { time: &[0.0, 0.1], pose: &[Pose::new(0.0, 0.0, 0.0), Pose::new(0.01, 0.0, 0.4)] };
    /// assert!((known.pose_at(0.025).unwrap().theta - 0.1).abs() < 1e-15);
    /// assert_eq!((known.pose_at(0.10005), known.pose_at(0.11)), (Some(known.pose[1]), None));
    /// ```
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Option<Pose> {
        let later = self.time.partition_point(|t| *t < time - SAME_TIME);
        let after = *self.time.get(later)?;
        if after <= time + SAME_TIME {
            return Some(self.pose[later]);
        }
        let earlier = later.checked_sub(1)?;
        let fraction = (time - self.time[earlier]) / (after - self.time[earlier]);
        Some(self.pose[earlier].interpolate(self.pose[later], fraction))
    }
}
