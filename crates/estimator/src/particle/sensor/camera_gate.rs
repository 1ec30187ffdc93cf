//! Decision whether camera poses that no particle explains are wrong, or the particles are (robust
//! model): [`CameraGate`].

use crate::tuning::{ACCEPTED_AFTER, UNEXPLAINED};
use stickslip_filter::StepReport;

/// Gate that accepts camera poses which no particle explains.
///
/// It counts such poses in a row. After some, they are no outliers, until one is explained.
///
/// It also accepts the first pose after a time in which neither object nor pusher was seen: the
/// object is then more likely to have been moved than the pose to be wrong.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameraGate {
    unexplained: u32,
    /// True if the next pose is accepted.
    open: bool,
}

impl CameraGate {
    /// Takes the next pose; `was_unwatched` is true if neither object nor pusher was seen since the
    /// pose before.
    ///
    /// Returns whether the pose is accepted, if that changes.
    pub fn expect(&mut self, was_unwatched: bool) -> Option<bool> {
        let open = was_unwatched || self.unexplained >= ACCEPTED_AFTER;
        let before = std::mem::replace(&mut self.open, open);
        Some(open).filter(|now| *now != before)
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
