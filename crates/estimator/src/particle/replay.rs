//! Steps in the dark that can be made again: [`Replay`] (contact mode).

use stickslip_filter::{Attempt, Checkpoint, ParticleFilter, Pool, StepReport, WeightUpdate};

use crate::filter_model::FilterModel;
use crate::particle::columns::Columns;
use crate::particle::model::ContactModel;
use crate::particle::observation::Observation;
use crate::particle::step_plan::StepPlan;

/// What happened since the camera last saw the object, so that it can be tried again.
///
/// In the dark particles go different ways at a bifurcation, and nothing brings them back: where
/// none went the way of the object, pusher and touch sensors go on contradicting all of them. Then
/// the steps since the blackout are made again with other random numbers, and all sets share the
/// particles by their evidence. Where that does not help, every other time they are made without
/// resampling: at a fork that one way explains better at first and the other in the end, resampling
/// leaves particles on the first.
#[derive(Debug, Default)]
pub(crate) struct Replay {
    checkpoint: Option<Checkpoint>,
    /// Whether the object is hidden, and `checkpoint` is where that began.
    dark: bool,
    /// The steps since, of which the first `made` count.
    steps: Vec<(StepPlan, Observation)>,
    made: usize,
    /// The sets of particles that made them, and the evidence of these steps.
    pool: Pool,
    /// Evidence below which they are made again.
    limit: f64,
    /// How often that was done since the blackout, and ever.
    attempts: u32,
    tries: u32,
    /// Ancestors below which a set that takes over has too few, and at how many more rows others
    /// are looked for.
    few: usize,
    more: u32,
}

/// Steps that are made again at most: what a row can cost.
const LONGEST: usize = 120;

/// Times that the steps of a blackout are made again at most.
const ATTEMPTS: u32 = 48;

/// Fall of ln of the evidence at which they are, the first [`EARLY`] times: 1 in 3000.
const WORSE: f64 = 8.0;

/// The first times: what can be found is mostly found by them.
const EARLY: u32 = 16;

/// And the other times. What a scene tells wrong, no try explains, and the evidence falls a little
/// at every touch; at a fork that all particles took the wrong way it falls at every row, by
/// hundreds in the end.
const MUCH_WORSE: f64 = 32.0;

/// Attempt from which on every other one does not resample. It leaves few particles, too few where
/// the evidence fell by chance.
const DECEIVED: u32 = 6;

/// Share of the particles from which on a set takes over that was made without resampling.
const TAKES_OVER: f64 = 0.9;

/// Ancestors below which its particles are too few, where the checkpoint has as many.
const FEW: usize = 8;

/// At how many rows steps are made again then, to find others that go its way.
const MORE: u32 = 8;

impl Replay {
    /// Before a step, in the dark or not: remembers the particles where it is the first one in the
    /// dark, or where the memory is full.
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

    /// After it. Where the particles explain what was measured in the dark too badly, makes all its
    /// steps again; returns by how much ln of the evidence has changed then.
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
        // it may be the bodies' give, which weighs no particle; or all of them went another way
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

    /// By how much ln of the evidence has to fall for the next attempt.
    fn fall(&self) -> f64 {
        if self.attempts < EARLY {
            WORSE
        } else {
            MUCH_WORSE
        }
    }

    /// Steps made so far are not made again: something else was learnt since, or there are other
    /// particles.
    pub fn forget(&mut self) {
        self.made = LONGEST;
    }

    /// How often steps were made again.
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

/// ln of the share of particles whose pusher stands within the bound of (13), each by how far it is
/// beyond that, (40).
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
