//! All that an experiment's files hold, as methods and scores take it: [`Experiment`].

use stickslip::{Log, Reference, Setup};

use crate::{SensorError, Truth, TruthFacts, check_sensors};

/// A scene, a log and what is known of the truth.
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

    /// What estimates are scored against: the truth at the log's times, else the log's own poses,
    /// hidden ones included.
    #[must_use]
    pub fn reference(&self) -> Reference {
        let reference = match &self.truth {
            Some(truth) => Reference::of_truth(&self.log, truth.trajectory()),
            None => Reference::of_log(&self.log, self.setup.camera.as_ref()),
        };
        Reference {
            first_pusher_contact: self.facts.first_pusher_contact,
            ..reference
        }
    }
}
