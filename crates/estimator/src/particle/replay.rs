//! Re-simulation of the steps while the camera is off: [`Replay`] (robust model).

use stickslip_filter::{Attempt, Checkpoint, ParticleFilter, Pool, StepReport, WeightUpdate};

use crate::filter_model::FilterModel;
use crate::particle::columns::Columns;
use crate::particle::model::ContactModel;
use crate::particle::observation::Observation;
use crate::particle::step_plan::StepPlan;

/// Steps since the camera last saw the object, which can be re-simulated.
///
/// Particles go different ways at a bifurcation while the camera is off, and nothing brings them
/// back. If none went the way of the object, pusher and touch sensors go on contradicting all of
/// them. Then the steps since the occlusion began are re-simulated with other random numbers, and
/// all sets share the particles by their evidence.
///
/// If that does not help, every other re-simulation runs without resampling. One way of a
/// bifurcation may explain the rows better at first and the other in the end: resampling leaves
/// particles only on the first.
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
    /// Number of ancestors below which a set that takes over has too few, and number of further
    /// rows at which others are looked for.
    few: usize,
    more: u32,
}

/// Largest number of steps that are re-simulated: it bounds the cost of a row.
const LONGEST: usize = 120;

/// Largest number of re-simulations in one occlusion.
const ATTEMPTS: u32 = 48;

/// Fall of ln of the evidence that causes a re-simulation, the first [`EARLY`] times: 1 in 3000.
const WORSE: f64 = 8.0;

/// Number of the first times, which find most of what can be found.
const EARLY: u32 = 16;

/// Fall that causes the other ones. No re-simulation explains what the scene states wrongly: the
/// evidence then falls a little at every touch. At a bifurcation that all particles took the wrong
/// way it falls at every row, by hundreds in the end.
const MUCH_WORSE: f64 = 32.0;

/// Attempt from which on every other one does not resample. Such an attempt leaves few particles,
/// too few if the evidence fell by chance.
const DECEIVED: u32 = 6;

/// Share of the particles from which on a set made without resampling takes over.
const TAKES_OVER: f64 = 0.9;

/// Number of ancestors below which its particles are too few, if the checkpoint has as many.
const FEW: usize = 8;

/// Number of rows at which steps are then re-simulated, to find others that go its way.
const MORE: u32 = 8;

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
        self.few = FEW.min(filter.lineage().ancestors());
        self.more = 0;
        self.made = 0;
        self.pool = Pool::default();
        self.limit = -self.fall();
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
        // the pusher's lag may be the bodies' compliance, which weighs no particle; or all
        // particles went another way
        if !plan.driven {
            self.limit -= log_share_beside(filter);
        }
        let contradicted = self.pool.log_evidence < self.limit;
        let few = self.more > 0 && filter.lineage().ancestors() < self.few;
        self.more = if few { self.more - 1 } else { 0 };
        if !(contradicted || few) || self.attempts == ATTEMPTS {
            return None;
        }
        let checkpoint = self.checkpoint.as_ref()?;
        self.attempts += 1;
        self.tries += 1;
        let steps = self.steps[..self.made].iter();
        let steps = steps.map(|(plan, observation)| (plan, Some(observation)));
        let before = self.pool;
        let attempt = Attempt {
            number: u64::from(self.attempts),
            resampling: contradicted && (self.attempts < DECEIVED || self.attempts % 2 == 1),
        };
        let tried = filter.try_again(checkpoint, steps, before, attempt);
        self.pool = tried.pool;
        if contradicted {
            let leaves_few = !attempt.resampling && tried.share > TAKES_OVER;
            self.more = if leaves_few { MORE } else { 0 };
            self.limit = self.pool.log_evidence - self.fall();
        } else {
            self.limit += self.pool.log_evidence - before.log_evidence;
        }
        Some(self.pool.log_evidence - before.log_evidence)
    }

    /// Returns the fall of ln of the evidence that causes the next attempt.
    fn fall(&self) -> f64 {
        if self.attempts < EARLY {
            WORSE
        } else {
            MUCH_WORSE
        }
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
        self.steps[self.made].0.second_try = true;
        self.made += 1;
    }
}

/// ln of the share of particles whose pusher stands within the bound of (13). A pusher beyond the
/// bound counts less, by its distance, (40).
fn log_share_beside(filter: &ParticleFilter<ContactModel<'_>>) -> f64 {
    let setup = filter.model().setup();
    let (bound, std) = (setup.most_pusher_lag(), setup.uncertainty.pusher_lag);
    let column = |axis: usize| filter.particles().column(Columns::PUSHER_LAG + axis);
    let weights = filter.weights().weights();
    let lags = column(0).zip(column(1)).zip(weights);
    let share: f64 = lags
        .map(|((x, y), weight)| {
            let beyond = (x * x + y * y - bound * bound).max(0.0);
            weight * libm::exp(-0.5 * beyond / (std * std))
        })
        .sum();
    libm::log(share.max(f64::MIN_POSITIVE))
}
