//! Bridge between the particle filter and the ensemble Kalman filter: [`Bridge`] (Frei & Künsch
//! 2013, "Bridging the ensemble Kalman and particle filters"); docs/model.md (45).
//!
//! An observation is split where weighing alone would leave few particles, or where a model asks
//! for it. One part of it weighs the particles, the rest moves them.

use stickslip_lanes::exponentials;

use crate::ensemble::{Ensemble, EnsembleShape};
use crate::filter::ParticleFilter;
use crate::model::Model;
use crate::particles::{BLOCK, ParticleSet};
use crate::streams::Purpose;
use crate::weights::LogWeights;

/// Share of the effective sample size that weighing is to leave, as far as moving can prevent it:
/// one that is left with a tenth less resamples once in some ten observations.
const LEFT: f64 = 0.9;

/// ln of the least likelihood, relative to the mean one, of particles that an observation moves
/// even though weighing alone would leave enough. Few lie farther from it than that, and the
/// covariances of the others say nothing of them.
const FAR: f64 = -8.0;

/// Weight of the particles near an observation below which it moves none.
const FEW_NEAR: f64 = 1e-3;

/// Halvings of the interval in which the share that moves is searched.
const HALVINGS: usize = 12;

/// Working memory for observations that move particles.
#[derive(Clone, Debug)]
pub(crate) struct Bridge {
    ensemble: Ensemble,
    /// Weights by a share of an observation, or weights of the particles that move, (N,).
    weights: Vec<f64>,
    /// True if the latest observation moved particles, or gave them other weights than the pass
    /// over them did.
    parted: bool,
}

impl Bridge {
    /// For these particles.
    pub fn new(shape: EnsembleShape, particles: &ParticleSet) -> Self {
        let moving = if shape == EnsembleShape::default() {
            0
        } else {
            particles.len()
        };
        Self {
            ensemble: Ensemble::new(shape, moving.div_ceil(BLOCK)),
            weights: vec![0.0; moving],
            parted: false,
        }
    }

    /// Returns true if sums of the pass over the particles are out of date: the latest observation
    /// was parted into a part that weighs them and a part that moves them.
    pub fn parted(&self) -> bool {
        self.parted
    }

    /// The effective sample size under likelihoods of which `share` of the part that moves is left
    /// out.
    fn size_without(
        &mut self,
        share: f64,
        weights: &LogWeights,
        log_likelihood: &[f64],
        moving: &[f64],
    ) -> f64 {
        let likelihoods = log_likelihood.iter().zip(moving);
        let given = weights.log_weights().iter().zip(likelihoods);
        let mut best = f64::NEG_INFINITY;
        for (weight, (log_weight, (all, moving))) in self.weights.iter_mut().zip(given) {
            *weight = log_weight + all - share * moving;
            best = best.max(*weight);
        }
        exponentials(&mut self.weights, best);
        let (mut sum, mut squares) = (0.0, 0.0);
        for weight in &self.weights {
            sum += weight;
            squares += weight * weight;
        }
        sum * sum / squares
    }

    /// Weights of the particles that move, summing to 1; the others have none. Returns true if
    /// their weight is large enough: the part of the observation that does not move particles can
    /// speak against all of them.
    fn weigh_near(&mut self, far: f64, weights: &LogWeights, moving: &[f64]) -> bool {
        self.weights.copy_from_slice(weights.weights());
        if moving.iter().all(|likelihood| *likelihood >= far) {
            return true;
        }
        for (weight, likelihood) in self.weights.iter_mut().zip(moving) {
            if *likelihood < far {
                *weight = 0.0;
            }
        }
        let near: f64 = self.weights.iter().sum();
        if near < FEW_NEAR {
            return false;
        }
        self.weights.iter_mut().for_each(|weight| *weight /= near);
        true
    }

    /// The smallest share of the part that moves, from `least` on, without which weighing leaves
    /// enough.
    fn share(
        &mut self,
        least: f64,
        weights: &LogWeights,
        log_likelihood: &[f64],
        moving: &[f64],
    ) -> f64 {
        let mut size = |share| self.size_without(share, weights, log_likelihood, moving);
        let enough = LEFT * size(1.0);
        if least > 0.0 && size(least) >= enough {
            return least;
        }
        let (mut few, mut share) = (least, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (few + share);
            if size(middle) < enough {
                few = middle;
            } else {
                share = middle;
            }
        }
        share
    }
}

impl<M: Model> ParticleFilter<M> {
    /// Bayes' rule with the likelihoods of the pass: by weighing alone where nothing may move, or
    /// that leaves enough particles and the model asks for no more, else by both. Returns ln of the
    /// evidence.
    ///
    /// `judged` is ln of the mean likelihood of the part that moves, where the model judges it.
    pub(crate) fn weigh_and_move(
        &mut self,
        observation: &M::Observation,
        judged: Option<f64>,
    ) -> Option<f64> {
        self.bridge.parted = false;
        if !self.model.moves(observation) {
            return self.weights.update(&mut self.unnormalised);
        }
        let all = self.unnormalised.normalise()?;
        let few = all.effective_sample_size < LEFT * self.weights.effective_sample_size();
        let mut least = self.model.least_moved(observation);
        if !few && least <= 0.0 {
            return self.weights.update(&mut self.unnormalised);
        }
        let evidence = judged.unwrap_or_else(|| self.resetting_log_evidence(observation));
        least *= self.model.plausibility(observation, evidence);
        if !few && least <= 0.0 {
            return self.weights.update(&mut self.unnormalised);
        }
        let far = if few {
            f64::NEG_INFINITY
        } else {
            evidence + FAR
        };
        let log_likelihood = &mut self.unnormalised.log_likelihood;
        let share = self
            .bridge
            .share(least, &self.weights, log_likelihood, &self.resetting);
        for (all, moving) in log_likelihood.iter_mut().zip(&self.resetting) {
            // a particle that does not move is weighed by all of it, relative to its weight for the
            // others
            *all -= share * if *moving < far { evidence } else { *moving };
        }
        self.unnormalised.weigh(&self.weights);
        self.bridge.parted = true;
        self.weights.update(&mut self.unnormalised)?;
        let bridge = &mut self.bridge;
        if bridge.weigh_near(far, &self.weights, &self.resetting) {
            self.move_particles(observation, share);
        }
        Some(all.log_sum)
    }

    /// Moves the particles by a share of the observation.
    fn move_particles(&mut self, observation: &M::Observation, share: f64) {
        let draw = self.draw(Purpose::Move);
        let first = self.observed * self.model.ensemble().errors as u32;
        let (model, ensemble) = (&self.model, &mut self.bridge.ensemble);
        self.particles.visit(ensemble.blocks_mut(), |block, to| {
            model.read_ensemble(observation, block, to);
        });
        ensemble.update(&self.bridge.weights, share, (draw, first));
        self.particles
            .advance(None, ensemble.blocks(), |block, from| {
                model.write_ensemble(from, block);
            });
    }
}
