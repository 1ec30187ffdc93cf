//! Whether camera poses that no particle explains are wrong, or the particles are (contact mode):
//! [`CameraTrust`].

use stickslip_dynamics::Pose;
use stickslip_filter::StepReport;

use crate::particle::normal_pose::NormalPose;

/// Camera poses in a row that nothing explains, after which they are believed.
pub(crate) const BELIEVED_AFTER: u32 = 4;

/// ln of the mean likelihood of a camera pose below which no particle explains it.
const UNEXPLAINED: f64 = -10.0;

/// ln of how much wider a belief is than a camera pose, all axes together, from which on few of its
/// particles are near one: some seven times per axis.
const WIDE: f64 = 6.0;

/// Half the squared distance, in its standard deviations, up to which such a belief expects a pose:
/// four of them.
const WITHIN: f64 = 8.0;

/// Counts the camera poses in a row that no particle explains; after some, they are no outliers,
/// until one is explained. Nor is one that a wide belief expects: that no particle is near it says
/// nothing. After a time in which nobody saw object or pusher, the object has been moved more often
/// than a pose is wrong.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameraTrust {
    unexplained: u32,
    /// Whether the pose that comes next is believed.
    believed: bool,
}

impl CameraTrust {
    /// Takes the pose that comes next, with its variances of x, y (m²) and θ (rad²), and the belief
    /// before it, where that may be wide, and whether anything may have happened since the pose
    /// before; says whether the pose is believed, where that changes.
    pub fn expect(
        &mut self,
        (pose, noise): (&Pose, [f64; 3]),
        belief: Option<&NormalPose>,
        was_unwatched: bool,
    ) -> Option<bool> {
        let expected = belief.is_some_and(|belief| {
            let at_best = belief.log_density(&belief.mean, noise);
            at_best < -WIDE && belief.log_density(pose, noise) - at_best > -WITHIN
        });
        let believed = expected || was_unwatched || self.unexplained >= BELIEVED_AFTER;
        let before = std::mem::replace(&mut self.believed, believed);
        Some(believed).filter(|now| *now != before)
    }

    /// Takes what a pose, on time or late, did to the particles.
    pub fn judge(&mut self, report: &StepReport) {
        let Some(log_evidence) = report.resetting_log_evidence else {
            return;
        };
        self.unexplained = match log_evidence < UNEXPLAINED {
            _ if report.collapsed() => self.unexplained,
            true => self.unexplained + 1,
            false => 0,
        };
    }
}
