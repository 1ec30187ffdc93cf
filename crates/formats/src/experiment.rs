//! All that an experiment's files hold, as methods and scores take it: [`Experiment`].

use stickslip::{Log, Setup};

use crate::log_csv::{BodiesError, check_bodies};
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
    /// The log has other fingers than the scene, or more sensors than the scene has bodies for
    /// them.
    pub fn new(
        setup: Setup,
        log: Log,
        truth: Option<Truth>,
        facts: TruthFacts,
    ) -> Result<Self, BodiesError> {
        check_bodies(&log, &setup)?;
        Ok(Self {
            setup,
            log,
            truth,
            facts,
        })
    }
}
