//! Importance weights of a particle set, as natural logarithms.
//!
//! Logarithms, because a product of many sensors' likelihoods underflows. Weights are kept
//! normalised: the linear weights `w_i = exp(log w_i)` sum to 1 up to rounding, at least one is
//! positive, none is NaN. Sums run in a fixed order, so they do not depend on threads.

use std::ops::Range;

use crate::update::{BlockUpdate, Normaliser, Update, best_alive, is_broken};
use crate::{BLOCK, parallel};

/// Blocks of weights that one thread takes at least.
const GRAIN: usize = 16;

/// Why weights were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightError {
    /// No weights at all.
    #[error("there are 0 weights; at least 1 is needed")]
    Empty,
    /// A weight is NaN or positive infinity.
    #[error(
        "the log-weight of particle {particle} is NaN or +inf; it must be finite or -inf; check the likelihood"
    )]
    NotANumber {
        /// Index of the first such weight.
        particle: usize,
    },
    /// Every weight is zero.
    #[error("all log-weights are -inf; at least one particle must have a positive weight")]
    AllZero,
}

/// Normalised importance weights of N particles.
///
/// ```
/// # use stickslip_filter::{LogWeights, WeightError};
/// assert_eq!(LogWeights::new(vec![5.0; 4])?.effective_sample_size(), 4.0);
/// assert_eq!(LogWeights::new(vec![0.0, f64::NEG_INFINITY])?.effective_sample_size(), 1.0);
/// assert_eq!(LogWeights::new(vec![f64::NEG_INFINITY; 4]), Err(WeightError::AllZero));
/// # Ok::<(), WeightError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LogWeights {
    log: Vec<f64>,
    linear: Vec<f64>,
    effective_sample_size: f64,
}

impl LogWeights {
    /// N equal weights, N >= 1.
    pub fn equal(particles: usize) -> Self {
        assert!(particles > 0, "a particle set is never empty");
        let mut weights = LogWeights {
            log: vec![0.0; particles],
            linear: vec![0.0; particles],
            effective_sample_size: 0.0,
        };
        weights.reset();
        weights
    }

    /// Weights from `log`, (N,) unnormalised natural logarithms; adding a constant changes nothing.
    ///
    /// # Errors
    /// If there are none, one is NaN or +inf, or all are -inf.
    pub fn new(log: Vec<f64>) -> Result<Self, WeightError> {
        if log.is_empty() {
            return Err(WeightError::Empty);
        }
        if let Some(particle) = log.iter().position(|&w| is_broken(w)) {
            return Err(WeightError::NotANumber { particle });
        }
        let certain = vec![0.0; log.len()];
        let mut weights = LogWeights {
            linear: certain.clone(),
            log,
            effective_sample_size: 0.0,
        };
        weights.multiply(&certain).ok_or(WeightError::AllZero)?;
        Ok(weights)
    }

    /// Makes all weights equal.
    pub fn reset(&mut self) {
        let n = self.log.len() as f64;
        self.log.fill(-libm::log(n));
        self.linear.fill(1.0 / n);
        self.effective_sample_size = n;
    }

    /// Bayes' rule: `w_i <- w_i L_i / sum_j w_j L_j`. `log_likelihood` holds (N,) ln L.
    ///
    /// Returns `ln sum_j w_j L_j`, the observation's log-evidence given those before it; or `None`,
    /// and leaves the weights as they were, if that sum is zero.
    ///
    /// # Panics
    /// If a likelihood is NaN or +inf: then the model is broken.
    pub fn multiply(&mut self, log_likelihood: &[f64]) -> Option<f64> {
        assert_eq!(log_likelihood.len(), self.log.len());
        let mut update = Update::new(self.log.len());
        for (block, (products, sums)) in update.blocks_mut().enumerate() {
            let range = block * BLOCK..block * BLOCK + products.len();
            *sums = self.weigh_block(range.clone(), &log_likelihood[range], products);
        }
        self.apply(&mut update, log_likelihood)
    }

    /// Writes what Bayes' rule makes of one block's weights, up to a factor.
    pub(crate) fn weigh_block(
        &self,
        range: Range<usize>,
        log_likelihood: &[f64],
        products: &mut [f64],
    ) -> BlockUpdate {
        BlockUpdate::of(range.start, &self.log[range], log_likelihood, products)
    }

    /// [`LogWeights::multiply`] where every block of `update` has been weighed.
    pub(crate) fn apply(&mut self, update: &mut Update, log_likelihood: &[f64]) -> Option<f64> {
        let Normaliser {
            log_sum,
            effective_sample_size,
        } = update.normalise()?;
        self.effective_sample_size = effective_sample_size;
        let log = self
            .log
            .chunks_mut(GRAIN * BLOCK)
            .zip(log_likelihood.chunks(GRAIN * BLOCK));
        parallel::for_all(log, |(log, log_likelihood)| {
            log.iter_mut()
                .zip(log_likelihood)
                .for_each(|(w, l)| *w = *w + l - log_sum);
        });
        parallel::for_all(
            self.linear
                .chunks_mut(GRAIN * BLOCK)
                .zip(update.grains(GRAIN)),
            |(linear, (products, blocks))| {
                for ((linear, products), block) in linear
                    .chunks_mut(BLOCK)
                    .zip(products.chunks(BLOCK))
                    .zip(blocks)
                {
                    linear
                        .iter_mut()
                        .zip(products)
                        .for_each(|(w, product)| *w = product * block.share());
                }
            },
        );
        Some(log_sum)
    }

    /// The largest of `log_likelihood` (N,) among the particles of positive weight.
    ///
    /// # Panics
    /// If one is NaN or +inf: then the model is broken.
    pub fn best(&self, log_likelihood: &[f64]) -> f64 {
        assert_eq!(log_likelihood.len(), self.log.len());
        best_alive(0, &self.log, log_likelihood)
    }

    /// The effective sample size `(sum w)^2 / sum w^2` (Kong, Liu & Wong 1994): N for equal
    /// weights, 1 when one particle holds all the mass.
    pub fn effective_sample_size(&self) -> f64 {
        self.effective_sample_size
    }

    /// The linear weights, (N,), summing to 1.
    pub fn weights(&self) -> &[f64] {
        &self.linear
    }

    /// The natural logarithms of the weights, (N,).
    pub fn log_weights(&self) -> &[f64] {
        &self.log
    }
}
