//! The particle filter: sequential importance resampling (Gordon, Salmond & Smith 1993; Doucet &
//! Johansen 2009, algorithm "SMC" with adaptive resampling), over any [`Model`].

use crate::bridge::Bridge;
use crate::lineage::Lineage;
use crate::model::{Model, WeightedSums};
use crate::particles::{BLOCK, ParticleSet};
use crate::report::{StepReport, WeightUpdate};
use crate::settings::{Settings, SettingsError};
use crate::streams::{Draw, Purpose, Streams};
use crate::threads::parallel::PerThread;
use crate::weights::{BlockWeights, LogWeights, UnnormalisedWeights};

/// A particle filter over a model. A clone draws the random numbers that the original draws: equal
/// observations give it equal particles.
#[derive(Clone)]
pub struct ParticleFilter<M: Model> {
    pub(crate) model: M,
    pub(crate) settings: Settings,
    pub(crate) streams: Streams,
    pub(crate) step: u64,
    /// Observations since the one of that step.
    pub(crate) observed: u32,
    pub(crate) particles: ParticleSet,
    pub(crate) weights: LogWeights,
    pub(crate) unnormalised: UnnormalisedWeights,
    /// Log-likelihoods for [`Model::resetting_log_likelihood`], (N,).
    pub(crate) resetting: Vec<f64>,
    pub(crate) bridge: Bridge,
    ancestors: Vec<u32>,
    pub(crate) lineage: Lineage,
    /// True if their number has changed since the last step.
    resized: bool,
    scratch: PerThread<M::Scratch>,
    /// The sums over every block, and over all.
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
        let blocks = 0..particles.block_count();
        let mut filter = ParticleFilter {
            streams: Streams::new(settings.seed),
            step: 0,
            observed: 0,
            weights: LogWeights::equal(settings.particles),
            unnormalised: UnnormalisedWeights::zeros(settings.particles),
            resetting: vec![0.0; settings.particles],
            bridge: Bridge::new(model.ensemble(), &particles),
            ancestors: vec![0; settings.particles],
            lineage: Lineage::new(settings.particles),
            resized: false,
            scratch: PerThread::new(blocks.len(), || model.scratch()),
            block_sums: blocks.map(|_| M::Sums::default()).collect(),
            sums: M::Sums::default(),
            particles,
            model,
            settings,
        };
        let (model, draw) = (&filter.model, filter.draw(Purpose::Initialise));
        filter
            .particles
            .for_each_block(|block| model.initialise(draw, block));
        Ok(filter)
    }

    /// One time step, the paper's algorithm (section III-D):
    ///
    /// ```text
    /// If satisfies resample condition
    ///     Resample all particles                      choose_ancestors, ParticleSet::advance
    /// For each particle i = 1, ..., N_p:
    ///     Run the system transition model             Model::propagate
    ///     Run observation model                       Model::log_likelihood
    ///     if sensory data is available
    ///         Update particle weight g_i              UnnormalisedBlock::weigh, LogWeights::update
    ///     else
    ///         Particle weight is unchanged
    ///     end
    /// Calculate estimated mean using {g_i}            Model::sum, combine_sums
    /// ```
    ///
    /// Work on one block of particles happens in one parallel pass over the blocks. Work on all of
    /// them comes before it (choosing ancestors) and after it (normalising the weights, adding the
    /// blocks' sums). If no particle explains the part of the observation that a reinitialisation
    /// can improve, or all weights are zero, the particles are reinitialised around it. If the
    /// model allows it, an observation also moves the particles: as far as weighing alone would
    /// leave few, or as far as the model asks for.
    pub fn step(&mut self, input: &M::Input, observation: Option<&M::Observation>) -> StepReport {
        self.step += 1;
        self.observed = 0;
        self.lineage.begin_step();
        let resampled = self.satisfies_resample_condition();
        if resampled {
            self.choose_ancestors(Purpose::Resample);
        }
        self.pass_over_blocks(resampled, input, observation);
        let (weight_update, judged) = match observation {
            Some(observation) => self.update_weights(observation),
            None => (WeightUpdate::Unobserved, None),
        };
        self.lineage.end_step();
        match weight_update {
            WeightUpdate::Unobserved => self.combine_sums(|_| 1.0),
            WeightUpdate::Weighed { .. } if self.bridge.parted() => self.recompute_sums(input),
            WeightUpdate::Weighed { .. } => self.combine_sums(BlockWeights::scale),
            WeightUpdate::Collapsed { .. } => self.recompute_sums(input),
        }
        let resized = std::mem::take(&mut self.resized);
        self.report(resampled || resized, weight_update, judged)
    }

    fn report(
        &self,
        resampled: bool,
        weight_update: WeightUpdate,
        resetting_log_evidence: Option<f64>,
    ) -> StepReport {
        StepReport {
            effective_sample_size: self.weights.effective_sample_size(),
            resampled,
            weight_update,
            resetting_log_evidence,
        }
    }

    fn satisfies_resample_condition(&self) -> bool {
        self.weights.effective_sample_size()
            < self.settings.resample_below * self.settings.particles as f64
    }

    /// Draws the ancestors by the weights, which become equal.
    fn choose_ancestors(&mut self, purpose: Purpose) {
        let draw = self.draw(purpose);
        let (model, particles) = (&self.model, &self.particles);
        self.weights.keep_only(|particle| {
            model.may_be_copied(&particles.block(particle / BLOCK), particle % BLOCK)
        });
        self.settings
            .resampling
            .ancestors(self.weights.weights(), draw, &mut self.ancestors);
        self.lineage.follow(&self.ancestors);
        self.weights.reset();
    }

    /// Goes on with another number of particles: resamples by the weights, which become equal. The
    /// estimate stays that of the last step. If the number is unchanged, nothing changes.
    ///
    /// # Errors
    /// If the number is out of range; nothing changes then.
    pub fn resize(&mut self, particles: usize) -> Result<(), SettingsError> {
        let settings = Settings {
            particles,
            ..self.settings
        };
        settings.check()?;
        if particles == self.settings.particles {
            return Ok(());
        }
        self.lineage.begin_step();
        self.resized = true;
        self.ancestors.resize(particles, 0);
        self.choose_ancestors(Purpose::Resize);
        let blocks_before = self.particles.block_count();
        self.particles = self.particles.gathered(&self.ancestors);
        self.settings = settings;
        self.weights = LogWeights::equal(particles);
        self.unnormalised = UnnormalisedWeights::zeros(particles);
        self.resetting.resize(particles, 0.0);
        self.bridge = Bridge::new(self.model.ensemble(), &self.particles);
        let blocks = self.particles.block_count();
        self.block_sums.resize_with(blocks, M::Sums::default);
        if blocks > blocks_before {
            self.scratch = PerThread::new(blocks, || self.model.scratch());
        }
        Ok(())
    }

    /// All stages of the step on one block after the other, while the block is in the cache.
    fn pass_over_blocks(
        &mut self,
        resample: bool,
        input: &M::Input,
        observation: Option<&M::Observation>,
    ) {
        let draw = self.draw(Purpose::Propagate);
        let (model, scratch, weights) = (&self.model, &self.scratch, &self.weights);
        let outputs = self.unnormalised.blocks_mut().zip(&mut self.block_sums);

        // resample: `advance` copies every particle's ancestor into the block
        let ancestors = resample.then_some(&*self.ancestors);
        self.particles
            .advance(ancestors, outputs, |block, (mut unnormalised, sums)| {
                // propagate
                scratch.with(|scratch| model.propagate(input, draw, block, scratch));

                // weigh
                let block = &block.as_block();
                let weights = match observation {
                    Some(observation) => {
                        model.log_likelihood(observation, block, unnormalised.log_likelihood);
                        unnormalised.weigh(weights, block.range())
                    }
                    None => &weights.weights()[block.range()],
                };

                // estimate
                model.sum(input, block, weights, sums);
            });
    }

    /// Bayes' rule with the likelihoods of the pass; after a collapse, reinitialises the particles.
    /// Also returns ln of the mean likelihood, by the weights before, of the part that
    /// reinitialising can improve, where the model judges it.
    fn update_weights(&mut self, observation: &M::Observation) -> (WeightUpdate, Option<f64>) {
        let judged = self.model.judges_resetting(observation);
        let judged = judged.then(|| self.resetting_log_evidence(observation));
        let mut best_log_likelihood = self.unnormalised.best_log_likelihood();
        if self.model.collapsed(best_log_likelihood) {
            best_log_likelihood = self.best_resetting_log_likelihood(observation);
        }
        if !self.model.collapsed(best_log_likelihood)
            && let Some(log_evidence) = self.weigh_and_move(observation, judged)
        {
            return (WeightUpdate::Weighed { log_evidence }, judged);
        }
        self.reinitialise(observation);
        let collapsed = WeightUpdate::Collapsed {
            best_log_likelihood,
        };
        (collapsed, judged)
    }

    /// Weighs the particles by one more observation of the step just made, such as one that arrives
    /// late; after a collapse, reinitialises them.
    pub fn observe(&mut self, input: &M::Input, observation: &M::Observation) -> StepReport {
        self.observed += 1;
        let (model, weights) = (&self.model, &self.weights);
        self.particles
            .visit(self.unnormalised.blocks_mut(), |block, mut unnormalised| {
                model.log_likelihood(observation, block, unnormalised.log_likelihood);
                unnormalised.weigh(weights, block.range());
            });
        let (weight_update, judged) = self.update_weights(observation);
        self.recompute_sums(input);
        self.report(false, weight_update, judged)
    }

    fn best_resetting_log_likelihood(&mut self, observation: &M::Observation) -> f64 {
        self.weigh_resetting(observation);
        self.weights.best_log_likelihood(&self.resetting)
    }

    /// ln of the mean of them, by the weights as they are.
    pub(crate) fn resetting_log_evidence(&mut self, observation: &M::Observation) -> f64 {
        self.weigh_resetting(observation);
        self.weights.log_mean_likelihood(&self.resetting)
    }

    /// Computes ln of the likelihoods of the part of the observation that reinitialising can
    /// improve, and that moves particles.
    pub(crate) fn weigh_resetting(&mut self, observation: &M::Observation) {
        let model = &self.model;
        self.particles
            .visit(self.resetting.chunks_mut(BLOCK), |block, out| {
                model.resetting_log_likelihood(observation, block, out)
            });
    }

    /// Sensor resetting (Lenser & Veloso 2000) after a collapse: resamples by the weights before
    /// the observation, then has the model redraw the particles around it.
    fn reinitialise(&mut self, observation: &M::Observation) {
        self.choose_ancestors(Purpose::ResampleAfterCollapse);
        let (model, draw) = (&self.model, self.draw(Purpose::Reinitialise));
        let blocks = 0..self.particles.block_count();
        self.particles
            .advance(Some(&self.ancestors), blocks, |block, _| {
                model.reinitialise(observation, draw, block)
            });
    }

    /// Takes the sums over the particles as they are now: before the first step, and where the
    /// particles changed after the pass.
    pub fn recompute_sums(&mut self, input: &M::Input) {
        let (model, weights) = (&self.model, self.weights.weights());
        self.particles
            .visit(self.block_sums.iter_mut(), |block, sums| {
                model.sum(input, block, &weights[block.range()], sums)
            });
        self.combine_sums(|_| 1.0);
    }

    /// Adds the blocks' sums in order, each times its block's `scale`.
    fn combine_sums(&mut self, scale: impl Fn(&BlockWeights) -> f64) {
        self.sums.clear();
        for (sums, block) in self.block_sums.iter().zip(self.unnormalised.blocks()) {
            self.sums.add(sums, scale(block));
        }
    }

    pub(crate) fn draw(&self, purpose: Purpose) -> Draw {
        self.streams.of(purpose).at(self.step)
    }

    /// The sums over the weighted particles after the last step or
    /// [`recompute_sums`](Self::recompute_sums); empty before.
    pub fn sums(&self) -> &M::Sums {
        &self.sums
    }

    /// The model.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// Changes the model between steps. If it has more columns afterwards, they are appended to
    /// every particle as zeros.
    ///
    /// # Panics
    /// If it has fewer columns than before.
    pub fn change_model(&mut self, change: impl FnOnce(&mut M)) {
        change(&mut self.model);
        let (before, after) = (self.particles.columns(), self.model.columns());
        assert!(after >= before, "{before} columns cannot shrink to {after}");
        if after > before {
            self.particles.append_columns(after - before);
            self.bridge = Bridge::new(self.model.ensemble(), &self.particles);
        }
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

    /// From which earlier particles they descend;
    /// [`count_ancestors_from_now`](Self::count_ancestors_from_now) says how early.
    pub fn lineage(&mut self) -> &mut Lineage {
        &mut self.lineage
    }

    /// Lets the lineage count ancestors among the particles as they are now.
    pub fn count_ancestors_from_now(&mut self) {
        self.lineage.begin_generation();
    }

    /// Their weights.
    pub fn weights(&self) -> &LogWeights {
        &self.weights
    }
}
