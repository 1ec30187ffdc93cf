//! The particle filter: sampling, importance weighting, resampling (Gordon, Salmond & Smith 1993;
//! Doucet & Johansen 2009, algorithm "SMC" with adaptive resampling), over any [`Model`].

use crate::parallel::PerThread;
use crate::update::{BlockUpdate, Update};
use crate::{
    BLOCK, Block, Draw, LogWeights, Model, ParticleSet, Purpose, Resampling, Streams, WeightedSums,
};

/// How a filter runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The number N of particles, at least 1.
    pub particles: usize,
    /// The seed of all random numbers.
    pub seed: u64,
    /// A step begins with resampling if the effective sample size is below this share of N; in [0,
    /// 1].
    pub resample_below: f64,
    /// The resampling scheme.
    pub resampling: Resampling,
}

impl Default for Settings {
    /// 500 particles, seed 0, systematic resampling below N/2.
    fn default() -> Self {
        Settings {
            particles: 500,
            seed: 0,
            resample_below: 0.5,
            resampling: Resampling::Systematic,
        }
    }
}

/// Why settings were refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The number of particles is 0 or does not fit u32.
    #[error("`particles` is {particles}; it must be at least 1 and below 2^32; try 500")]
    Particles {
        /// The number found.
        particles: usize,
    },
    /// The threshold is not a share.
    #[error("`resample_below` is {share}; it is a share of the particles in [0, 1]; try 0.5")]
    ResampleBelow {
        /// The number found.
        share: f64,
    },
}

impl Settings {
    fn check(&self) -> Result<(), SettingsError> {
        let Settings {
            particles,
            resample_below: share,
            ..
        } = *self;
        if particles == 0 || u32::try_from(particles).is_err() {
            return Err(SettingsError::Particles { particles });
        }
        if !(0.0..=1.0).contains(&share) {
            return Err(SettingsError::ResampleBelow { share });
        }
        Ok(())
    }
}

/// What became of a step's observation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub enum Weighing {
    /// There was none; the weights are unchanged.
    Unobserved,
    /// The weights were multiplied by its likelihood.
    Weighed {
        /// ln p(observation | observations before), as the particles see it.
        log_evidence: f64,
    },
    /// No particle explained it; the set was drawn anew around it and the weights are equal.
    Collapsed {
        /// The largest log-likelihood that a particle gave it, of what a redraw can raise.
        best_log_likelihood: f64,
    },
}

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct StepReport {
    /// The effective sample size after weighing, in [1, N].
    pub effective_sample_size: f64,
    /// Whether the step began with resampling.
    pub resampled: bool,
    /// What became of the observation.
    pub weighing: Weighing,
}

impl StepReport {
    /// Whether no particle explained the observation.
    pub fn collapsed(&self) -> bool {
        matches!(self.weighing, Weighing::Collapsed { .. })
    }
}

/// A particle filter over a model.
pub struct ParticleFilter<M: Model> {
    model: M,
    settings: Settings,
    streams: Streams,
    step: u64,
    particles: ParticleSet,
    weights: LogWeights,
    scratch: PerThread<M::Scratch>,
    log_likelihood: Vec<f64>,
    redrawn_log_likelihood: Vec<f64>,
    ancestors: Vec<u32>,
    update: Update,
    /// One of every block, and of all.
    block_sums: Vec<M::Sums>,
    sums: M::Sums,
}

impl<M: Model> ParticleFilter<M> {
    /// A filter whose particles are the model's initial draw, with equal weights.
    ///
    /// # Errors
    /// If the settings are out of range.
    pub fn new(model: M, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        let particles = ParticleSet::zeros(settings.particles, model.columns());
        let mut filter = ParticleFilter {
            streams: Streams::new(settings.seed),
            step: 0,
            weights: LogWeights::equal(settings.particles),
            scratch: PerThread::new(|| model.scratch()),
            log_likelihood: vec![0.0; settings.particles],
            redrawn_log_likelihood: vec![0.0; settings.particles],
            ancestors: vec![0; settings.particles],
            update: Update::new(settings.particles),
            block_sums: (0..particles.block_count())
                .map(|_| M::Sums::default())
                .collect(),
            sums: M::Sums::default(),
            particles,
            model,
            settings,
        };
        filter.initialise();
        Ok(filter)
    }

    /// One step: resample where needed, propagate, weigh by the observation if there is one.
    pub fn step(&mut self, input: &M::Input, observation: Option<&M::Observation>) -> StepReport {
        self.step += 1;
        let resampled = self.is_degenerate();
        self.advance(resampled, input, observation);
        let weighing = match observation {
            Some(observation) => self.weigh(observation),
            None => Weighing::Unobserved,
        };
        match weighing {
            Weighing::Unobserved => self.add_up(|_| 1.0),
            Weighing::Weighed { .. } => self.add_up(BlockUpdate::share),
            Weighing::Collapsed { .. } => self.sum_anew(input),
        }
        StepReport {
            effective_sample_size: self.weights.effective_sample_size(),
            resampled,
            weighing,
        }
    }

    fn is_degenerate(&self) -> bool {
        self.weights.effective_sample_size()
            < self.settings.resample_below * self.settings.particles as f64
    }

    fn initialise(&mut self) {
        let (model, draw) = (&self.model, self.draw(Purpose::Initialise));
        self.particles
            .for_each_block(|block| model.initialise(draw, block));
    }

    /// Resamples where asked to, propagates, weighs and sums, all of it block by block.
    fn advance(&mut self, resample: bool, input: &M::Input, observation: Option<&M::Observation>) {
        if resample {
            self.choose_ancestors(Purpose::Resample);
        }
        let (model, scratch, weights, draw) = (
            &self.model,
            &self.scratch,
            &self.weights,
            self.draw(Purpose::Propagate),
        );
        let ancestors = resample.then_some(&*self.ancestors);
        let with = self
            .log_likelihood
            .chunks_mut(BLOCK)
            .zip(self.update.blocks_mut())
            .zip(&mut self.block_sums);
        self.particles.advance(
            ancestors,
            with,
            |block, ((log_likelihood, (products, update)), sums)| {
                scratch.lend(|scratch| model.propagate(input, draw, block, scratch));
                let block = &block.as_block();
                let Some(observation) = observation else {
                    return model.sum(input, block, &weights.weights()[block.range()], sums);
                };
                model.log_likelihood(observation, block, log_likelihood);
                *update = weights.weigh_block(block.range(), log_likelihood, products);
                model.sum(input, block, products, sums);
            },
        );
    }

    /// Multiplies the weights by the likelihoods just taken.
    fn weigh(&mut self, observation: &M::Observation) -> Weighing {
        let model = &self.model;
        let mut best_log_likelihood = self.update.best_log_likelihood();
        if model.collapsed(best_log_likelihood) {
            let part = &mut self.redrawn_log_likelihood;
            self.particles.visit(part.chunks_mut(BLOCK), |block, out| {
                model.redrawn_log_likelihood(observation, block, out)
            });
            best_log_likelihood = self.weights.best(part);
        }
        if !model.collapsed(best_log_likelihood)
            && let Some(log_evidence) = self.weights.apply(&mut self.update, &self.log_likelihood)
        {
            return Weighing::Weighed { log_evidence };
        }
        self.recover(observation);
        Weighing::Collapsed {
            best_log_likelihood,
        }
    }

    /// After a collapse: resample by the weights before the observation, then draw anew around it.
    fn recover(&mut self, observation: &M::Observation) {
        self.choose_ancestors(Purpose::Recover);
        let (model, draw) = (&self.model, self.draw(Purpose::Redraw));
        let blocks = 0..self.particles.block_count();
        self.particles
            .advance(Some(&self.ancestors), blocks, |block, _| {
                model.redraw(observation, draw, block)
            });
    }

    /// Takes the sums over the particles as they are now.
    pub fn sum_anew(&mut self, input: &M::Input) {
        let (model, weights) = (&self.model, self.weights.weights());
        self.particles
            .visit(self.block_sums.iter_mut(), |block, sums| {
                model.sum(input, block, &weights[block.range()], sums)
            });
        self.add_up(|_| 1.0);
    }

    /// Adds the blocks' sums, each times its share, in order.
    fn add_up(&mut self, share: impl Fn(&BlockUpdate) -> f64) {
        self.sums.clear();
        for (sums, update) in self.block_sums.iter().zip(self.update.blocks()) {
            self.sums.add(sums, share(update));
        }
    }

    /// The sums over the particles after the last step; before one, over none.
    pub fn sums(&self) -> &M::Sums {
        &self.sums
    }

    /// Draws the ancestors by the weights, which become equal.
    fn choose_ancestors(&mut self, purpose: Purpose) {
        let draw = self.draw(purpose);
        self.settings
            .resampling
            .ancestors(self.weights.weights(), draw, &mut self.ancestors);
        self.weights.reset();
    }

    fn draw(&self, purpose: Purpose) -> Draw {
        self.streams.of(purpose).at(self.step)
    }

    /// The model.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The number of steps made.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// The particles.
    pub fn particles(&self) -> &ParticleSet {
        &self.particles
    }

    /// Their weights.
    pub fn weights(&self) -> &LogWeights {
        &self.weights
    }

    /// `map(block, its weights)` of every block, combined over a fixed tree: the same bits on any
    /// number of threads.
    pub fn reduce<A: Send>(
        &self,
        map: impl Fn(&Block<'_>, &[f64]) -> A + Sync,
        combine: impl Fn(A, A) -> A + Sync,
    ) -> A {
        let weights = self.weights.weights();
        self.particles
            .reduce(|block| map(block, &weights[block.range()]), combine)
    }
}
