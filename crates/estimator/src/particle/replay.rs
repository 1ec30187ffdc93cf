//! Re-simulation of the steps while the camera is off: [`Replay`] (robust model).

use stickslip_filter::{Checkpoint, ParticleFilter, Pool, StepReport, WeightUpdate};

use crate::filter_model::FilterModel;
use crate::particle::model::ContactModel;
use crate::particle::observation::Observation;
use crate::particle::step_plan::StepPlan;

/// Steps since the camera last saw the object, which can be re-simulated.
///
/// Particles go different ways at a bifurcation while the camera is off, and nothing brings them
/// back. If none went the way of the object, pusher and touch sensors go on contradicting all of
/// them. Then the steps since the occlusion began are re-simulated with other random numbers, and
/// all sets share the particles by their evidence.
#[derive(Debug, Default)]
pub(crate) struct Replay {
    checkpoint: Option<Checkpoint>,
    /// True if the object is hidden, and `checkpoint` is where that began.
    dark: bool,
    /// Steps since then, of which the first `made` count.
    steps: Vec<(StepPlan, Observation)>,
    made: usize,
    /// Sets of particles that made these steps, and the evidence of the steps.
    pool: Pool,
    /// ln of the evidence below which the steps are re-simulated.
    limit: f64,
    /// Number of re-simulations since the occlusion began, and in all.
    attempts: u32,
    tries: u32,
}

/// Largest number of steps that are re-simulated: it bounds the cost of a row.
const LONGEST: usize = 120;

/// Largest number of re-simulations in one occlusion.
const ATTEMPTS: u32 = 16;

/// Fall of ln of the evidence that causes a re-simulation: 1 in 3000.
const WORSE: f64 = 8.0;

impl Replay {
    /// Prepares a step. If the camera is off, it saves the particles at the first such step, and
    /// again when the memory is full.
    pub fn before(&mut self, filter: &mut ParticleFilter<ContactModel<'_>>, dark: bool) {
        if !dark || filter.model().columns().model() == FilterModel::Paper {
            self.dark = false;
            return;
        }
        let columns = filter.particles().columns();
        let saved = self.checkpoint.as_ref();
        let same = saved.is_some_and(|saved| saved.columns() == columns);
        if self.dark && same && self.made < LONGEST {
            return;
        }
        match &mut self.checkpoint {
            Some(checkpoint) => filter.save(checkpoint),
            none => *none = Some(filter.checkpoint()),
        }
        if !self.dark {
            self.attempts = 0;
        }
        self.dark = true;
        self.made = 0;
        self.pool = Pool::default();
        self.limit = -WORSE;
    }

    /// Completes a step. If the particles explain the measurements of the occlusion too badly, it
    /// re-simulates all its steps. It then returns the change of ln of the evidence.
    pub fn after(
        &mut self,
        filter: &mut ParticleFilter<ContactModel<'_>>,
        (plan, observation): (&StepPlan, &Observation),
        report: &StepReport,
    ) -> Option<f64> {
        if !self.dark {
            return None;
        }
        self.remember(plan, observation);
        if let WeightUpdate::Weighed { log_evidence } = report.weight_update {
            self.pool.log_evidence += log_evidence;
        }
        self.limit = self.limit.max(self.pool.log_evidence - WORSE);
        if self.pool.log_evidence >= self.limit || self.attempts == ATTEMPTS {
            return None;
        }
        let checkpoint = self.checkpoint.as_ref()?;
        self.attempts += 1;
        self.tries += 1;
        let steps = self.steps[..self.made].iter();
        let steps = steps.map(|(plan, observation)| (plan, Some(observation)));
        let before = self.pool;
        self.pool = filter
            .try_again(checkpoint, steps, before, u64::from(self.attempts))
            .pool;
        self.limit = self.pool.log_evidence - WORSE;
        Some(self.pool.log_evidence - before.log_evidence)
    }

    /// Excludes the steps so far from re-simulation: something else was learned since, or there are
    /// other particles.
    pub fn forget(&mut self) {
        self.made = LONGEST;
    }

    /// Number of re-simulations.
    pub fn tries(&self) -> u32 {
        self.tries
    }

    fn remember(&mut self, plan: &StepPlan, observation: &Observation) {
        match self.steps.get_mut(self.made) {
            Some((kept_plan, kept_observation)) => {
                kept_plan.overwrite(plan);
                kept_observation.overwrite(observation);
            }
            None => self.steps.push((plan.clone(), observation.clone())),
        }
        self.made += 1;
    }
}
