//! Re-simulation. If the particles explain their observations ever worse, the steps since a
//! [`Checkpoint`] are re-simulated with other random numbers, see [`ParticleFilter::try_again`].

use crate::filter::{ParticleFilter, Summing};
use crate::lineage::Lineage;
use crate::model::Model;
use crate::particles::{BLOCK, ParticleSet};
use crate::report::WeightUpdate;
use crate::streams::{Purpose, Streams};
use crate::weights::LogWeights;

/// The particles and weights of one step.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    step: u64,
    particles: ParticleSet,
    weights: LogWeights,
    lineage: Lineage,
}

/// Independent sets of particles that made the same steps, drawn together into one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pool {
    /// Number of sets.
    pub sets: u32,
    /// ln of the mean of their evidences.
    pub log_evidence: f64,
}

impl Pool {
    /// One set with this evidence.
    pub fn of_one(log_evidence: f64) -> Self {
        Self {
            sets: 1,
            log_evidence,
        }
    }

    /// With one more set, and the share of all evidence that is its.
    fn with(self, log_evidence: f64) -> (Self, f64) {
        let sets = f64::from(self.sets);
        let best = log_evidence.max(self.log_evidence);
        let new = libm::exp(log_evidence - best);
        let sum = sets * libm::exp(self.log_evidence - best) + new;
        let pool = Self {
            sets: self.sets + 1,
            log_evidence: best + libm::log(sum / (sets + 1.0)),
        };
        (pool, new / sum)
    }
}

impl Default for Pool {
    /// One set that has made no step yet.
    fn default() -> Self {
        Self::of_one(0.0)
    }
}

/// Fall of ln of a try's evidence below that of the sets before it, at most: 1 in 10²¹. A try that
/// falls farther would have no particle, and makes no more steps.
const GIVEN_UP: f64 = 50.0;

/// Result of a re-simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondTry {
    /// ln of the evidence of the steps since the checkpoint under the new particles; −∞ where they
    /// explained some step not at all, or the try was given up.
    pub log_evidence: f64,
    /// All sets so far, those whose particles are the present ones.
    pub pool: Pool,
    /// Share of the particles that are new ones now.
    pub share: f64,
}

impl Checkpoint {
    /// Columns of its particles.
    pub fn columns(&self) -> usize {
        self.particles.columns()
    }
}

impl<M: Model> ParticleFilter<M> {
    /// The particles as they are now.
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            step: self.step,
            particles: self.particles.clone(),
            weights: self.weights.clone(),
            lineage: self.lineage.clone(),
        }
    }

    /// Keeps the particles as they are now in `checkpoint`; allocates nothing where as many were
    /// kept.
    pub fn save(&self, checkpoint: &mut Checkpoint) {
        checkpoint.step = self.step;
        checkpoint.particles.copy_from(&self.particles);
        checkpoint.weights.clone_from(&self.weights);
        checkpoint.lineage.clone_from(&self.lineage);
    }

    /// Re-simulates all steps since `checkpoint`, with random numbers of its `number`, from 1 on.
    /// Then draws particles from the new set and from the sets in `pool`, which the present
    /// particles are drawn from. The share of each set is its share of the evidence. The weights
    /// become equal.
    ///
    /// Independent particle filters of the same observations, each weighed by its estimate of their
    /// likelihood, act as one filter with as many particles as all have (Del Moral 2004, section
    /// 7.4).
    ///
    /// A new set is given up, and gets no share, as soon as its evidence is below e⁻⁵⁰ of the mean
    /// of the others'. With a model whose likelihoods are at most 1 that is exact but for one
    /// particle in 10²¹. With another, a step whose evidence would be above e⁵⁰ comes too late.
    ///
    /// # Panics
    /// If the checkpoint is not as many steps old as there are `steps`, or of another number of
    /// particles or columns.
    pub fn try_again<'a>(
        &mut self,
        checkpoint: &Checkpoint,
        steps: impl ExactSizeIterator<Item = (&'a M::Input, Option<&'a M::Observation>)>,
        pool: Pool,
        number: u64,
    ) -> SecondTry
    where
        M::Input: 'a,
        M::Observation: 'a,
    {
        let now = self.step;
        assert_eq!(checkpoint.step + steps.len() as u64, now, "all steps since");
        assert_eq!(
            (checkpoint.particles.len(), checkpoint.particles.columns()),
            (self.particles.len(), self.particles.columns()),
            "particles as they are now"
        );

        // go back, and come again
        let mut rivals = checkpoint.clone();
        std::mem::swap(&mut self.particles, &mut rivals.particles);
        std::mem::swap(&mut self.weights, &mut rivals.weights);
        std::mem::swap(&mut self.lineage, &mut rivals.lineage);
        self.step = checkpoint.step;
        self.streams = Streams::new(self.settings.seed).attempt(number);
        let mut again = 0.0;
        let mut last = None;
        for (input, observation) in steps {
            last = Some(input);
            if again == f64::NEG_INFINITY {
                continue;
            }
            let report = self.make_step(input, observation, Summing::Off);
            again += match report.weight_update {
                WeightUpdate::Unobserved => 0.0,
                WeightUpdate::Weighed { log_evidence } => log_evidence,
                WeightUpdate::Collapsed { .. } => f64::NEG_INFINITY,
            };
            if again < pool.log_evidence - GIVEN_UP {
                again = f64::NEG_INFINITY;
            }
        }
        self.step = now;
        self.streams = Streams::new(self.settings.seed);

        // as many of each as their evidence is worth
        let (pool, share) = pool.with(again);
        for (weights, particles) in [
            (&mut self.weights, &self.particles),
            (&mut rivals.weights, &rivals.particles),
        ] {
            keep_failed_out(&self.model, particles, weights);
        }
        let before = rivals.weights.weights().iter();
        let weights: Vec<f64> = (self.weights.weights().iter().map(|w| w * share))
            .chain(before.map(|w| w * (1.0 - share)))
            .collect();
        let mut ancestors = vec![0; self.particles.len()];
        let draw = self.draw(Purpose::SecondTry);
        let resampling = self.settings.resampling;
        resampling.ancestors(&weights, draw, &mut ancestors);
        self.particles.gather_from(&rivals.particles, &ancestors);
        self.lineage.follow_both(&rivals.lineage, &ancestors);
        self.weights.reset();
        if let Some(input) = last {
            self.recompute_sums(input);
        }
        SecondTry {
            log_evidence: again,
            pool,
            share,
        }
    }
}

/// Leaves weight to particles only that may be copied.
pub(crate) fn keep_failed_out<M: Model>(
    model: &M,
    particles: &ParticleSet,
    weights: &mut LogWeights,
) {
    weights.keep_only(|particle| {
        model.may_be_copied(&particles.block(particle / BLOCK), particle % BLOCK)
    });
}
