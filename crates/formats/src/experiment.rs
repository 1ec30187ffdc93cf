//! All that an experiment's files hold, as methods and scores take it: [`Experiment`].

use stickslip::{Log, Setup};

use crate::log_csv::{SensorError, check_sensors};
use crate::truth_csv::Truth;
use crate::truth_json::TruthFacts;

/// A scene, a log and the known part of the truth.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Scene, sensors and filter settings.
    pub setup: Setup,
    /// The log.
    pub log: Log,
    /// The exact motion, where it is known.
    pub truth: Option<Truth>,
    /// True friction values and events; all `None` where nothing is known.
    pub facts: TruthFacts,
}

impl Experiment {
    /// The four together.
    ///
    /// # Errors
    /// The log has more sensors than the scene has fixels.
    pub fn new(
        setup: Setup,
        log: Log,
        truth: Option<Truth>,
        facts: TruthFacts,
    ) -> Result<Self, SensorError> {
        check_sensors(&log, &setup)?;
        Ok(Self {
            setup,
            log,
            truth,
            facts,
        })
    }
}
