//! Whether camera poses that no particle explains are wrong, or the particles are (contact mode): [`CameraTrust`].

use stickslip_filter::StepReport;

/// Camera poses in a row that nothing explains, after which they are believed.
pub(crate) const BELIEVED_AFTER: u32 = 4;

/// ln of the mean likelihood of a camera pose below which no particle explains it.
const UNEXPLAINED: f64 = -10.0;

/// Counts the camera poses in a row that no particle explains; after some, they are no outliers, until one is explained.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameraTrust {
    unexplained: u32,
}

impl CameraTrust {
    /// Takes what a pose, on time or late, did to the particles; says whether poses are believed where that changes.
    pub fn judge(&mut self, report: &StepReport) -> Option<bool> {
        let log_evidence = report.resetting_log_evidence?;
        let before = self.is_full();
        self.unexplained = match log_evidence < UNEXPLAINED {
            _ if report.collapsed() => self.unexplained,
            true => self.unexplained + 1,
            false => 0,
        };
        Some(self.is_full()).filter(|now| *now != before)
    }

    fn is_full(self) -> bool {
        self.unexplained >= BELIEVED_AFTER
    }
}
