//! Decision whether camera poses that no particle explains are wrong, or the particles are (robust
//! model): [`CameraTrust`].

use stickslip_dynamics::Pose;
use stickslip_filter::StepReport;

use crate::particle::normal_pose::NormalPose;

/// Number of unexplained camera poses in a row after which the next one is accepted.
pub(crate) const BELIEVED_AFTER: u32 = 4;

/// ln of the mean likelihood of a camera pose below which no particle explains it.
const UNEXPLAINED: f64 = -10.0;

/// ln of the width of a belief relative to a camera pose, all axes together, from which on few of
/// its particles are near one: some seven times per axis.
const WIDE: f64 = 6.0;

/// Half the squared distance up to which such a belief expects a pose, in its standard deviations:
/// four of them.
const WITHIN: f64 = 8.0;

/// Gate that accepts camera poses which no particle explains.
///
/// It counts such poses in a row. After some, they are no outliers, until one is explained.
///
/// It also accepts a pose that a wide belief expects: its particles are too sparse for one to be
/// near. It also accepts the first pose after a time in which neither object nor pusher was seen:
/// the object is then more likely to have been moved than the pose to be wrong.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameraTrust {
    unexplained: u32,
    /// True if the next pose is accepted.
    believed: bool,
}

impl CameraTrust {
    /// Takes the next pose, with its variances of x, y (m²) and θ (rad²). `belief` is the belief
    /// before it, if that may be wide. `was_unwatched` is true if neither object nor pusher was
    /// seen since the pose before.
    ///
    /// Returns whether the pose is accepted, if that changes.
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

    /// Takes the effect that a pose, on time or late, had on the particles.
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
