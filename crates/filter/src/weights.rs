//! Importance weights of a particle set, as natural logarithms, and Bayes' rule on them.
//!
//! Logarithms, because a product of many sensors' likelihoods underflows. Weights are kept
//! normalised: the linear weights `w_i = exp(log w_i)` sum to 1 up to rounding, at least one is
//! positive, none is NaN. Sums run in a fixed order, so they do not depend on threads.
//!
//! The largest w L of all is known only after all blocks are weighed. So that a block can be
//! weighed while it is in the cache, its unnormalised weights are relative to the block's own
//! largest, and a block scale normalises them afterwards: [`UnnormalisedWeights`].

use std::ops::Range;

use stickslip_lanes::exponentials;

use crate::particles::BLOCK;
use crate::threads::parallel;

/// Particles whose weights one thread normalises at least: fewer take less time than a thread takes
/// to come and help.
const GRAIN: usize = 256 * BLOCK;

/// Independent partial results: a single one would wait for every operation before it.
const PARTIAL: usize = 8;

/// Reason why weights were refused.
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

    /// Takes the weight of the other particles, unless nothing would be left; does nothing where
    /// all are kept.
    pub(crate) fn keep_only(&mut self, keep: impl Fn(usize) -> bool) {
        if (0..self.linear.len()).all(&keep) {
            return;
        }
        let weights = self.linear.iter().enumerate();
        let kept: f64 = weights.filter(|(i, _)| keep(*i)).map(|(_, w)| w).sum();
        if kept == 0.0 {
            return;
        }
        for (i, (linear, log)) in self.linear.iter_mut().zip(&mut self.log).enumerate() {
            (*linear, *log) = if keep(i) {
                (*linear / kept, *log - libm::log(kept))
            } else {
                (0.0, f64::NEG_INFINITY)
            };
        }
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
        let mut unnormalised = UnnormalisedWeights::zeros(self.log.len());
        unnormalised.log_likelihood.copy_from_slice(log_likelihood);
        unnormalised.weigh(self);
        self.update(&mut unnormalised)
    }

    /// [`LogWeights::multiply`] with likelihoods by which every block has been weighed.
    pub(crate) fn update(&mut self, unnormalised: &mut UnnormalisedWeights) -> Option<f64> {
        let Normalisation {
            log_sum,
            effective_sample_size,
        } = unnormalised.normalise()?;
        self.effective_sample_size = effective_sample_size;

        // ln w + ln L − ln Σ w L
        let log = self.log.chunks_mut(GRAIN);
        let log = log.zip(unnormalised.log_likelihood.chunks(GRAIN));
        parallel::for_each(log, |(log, log_likelihood)| {
            for (w, l) in log.iter_mut().zip(log_likelihood) {
                *w = *w + l - log_sum;
            }
        });

        // w L times the scale of its block
        let linear = self.linear.chunks_mut(GRAIN);
        let linear = linear.zip(unnormalised.weights.chunks(GRAIN));
        let linear = linear.zip(unnormalised.blocks.chunks(GRAIN / BLOCK));
        parallel::for_each(linear, |((linear, unnormalised), blocks)| {
            let pairs = linear.chunks_mut(BLOCK).zip(unnormalised.chunks(BLOCK));
            for ((linear, unnormalised), block) in pairs.zip(blocks) {
                for (w, u) in linear.iter_mut().zip(unnormalised) {
                    *w = u * block.scale;
                }
            }
        });
        Some(log_sum)
    }

    /// The largest of `log_likelihood` (N,) among the particles of positive weight.
    ///
    /// # Panics
    /// If one is NaN or +inf: then the model is broken.
    pub fn best_log_likelihood(&self, log_likelihood: &[f64]) -> f64 {
        assert_eq!(log_likelihood.len(), self.log.len());
        best_log_likelihood(0, &self.log, log_likelihood)
    }

    /// ln of the weighted mean of likelihoods.
    pub(crate) fn log_mean_likelihood(&self, log_likelihood: &[f64]) -> f64 {
        let best = self.best_log_likelihood(log_likelihood);
        let of_best = log_likelihood.iter().map(|l| libm::exp(l - best));
        let terms = of_best
            .zip(&self.linear)
            .map(|(likelihood, weight)| likelihood * weight);
        best + libm::log(terms.sum())
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

/// The unnormalised weights w L of a set, w the weights before and L the likelihoods, each block's
/// up to a factor of its own.
#[derive(Clone, Debug)]
pub(crate) struct UnnormalisedWeights {
    /// ln L, (N,).
    pub log_likelihood: Vec<f64>,
    /// w L e^(-block's `log_factor`), (N,).
    weights: Vec<f64>,
    blocks: Vec<BlockWeights>,
}

/// One block of [`UnnormalisedWeights`].
pub(crate) struct UnnormalisedBlock<'a> {
    /// ln L, for the model to write before [`weigh`](Self::weigh).
    pub log_likelihood: &'a mut [f64],
    weights: &'a mut [f64],
    sums: &'a mut BlockWeights,
}

/// Sums over the unnormalised weights of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockWeights {
    /// Largest ln L of a particle of positive weight.
    best_log_likelihood: f64,
    /// Largest ln w L; relative to its exponential the weights cannot overflow.
    log_factor: f64,
    sum: f64,
    sum_of_squares: f64,
    scale: f64,
}

/// Sums over a whole set.
pub(crate) struct Normalisation {
    /// ln Σ w L.
    pub log_sum: f64,
    /// (Σ w L)² / Σ (w L)².
    pub effective_sample_size: f64,
}

impl UnnormalisedWeights {
    /// Of so many particles, to be weighed block by block.
    pub fn zeros(particles: usize) -> Self {
        let block = BlockWeights {
            best_log_likelihood: f64::NEG_INFINITY,
            log_factor: f64::NEG_INFINITY,
            sum: 0.0,
            sum_of_squares: 0.0,
            scale: 0.0,
        };
        Self {
            log_likelihood: vec![0.0; particles],
            weights: vec![0.0; particles],
            blocks: vec![block; particles.div_ceil(BLOCK)],
        }
    }

    /// The blocks in order, to be weighed.
    pub fn blocks_mut(
        &mut self,
    ) -> impl ExactSizeIterator<Item = UnnormalisedBlock<'_>> + DoubleEndedIterator + Send {
        let numbers = self.log_likelihood.chunks_mut(BLOCK);
        let numbers = numbers.zip(self.weights.chunks_mut(BLOCK));
        let block = |((log_likelihood, weights), sums)| UnnormalisedBlock {
            log_likelihood,
            weights,
            sums,
        };
        numbers.zip(&mut self.blocks).map(block)
    }

    /// Bayes' rule on all blocks, whose likelihoods have been written.
    pub fn weigh(&mut self, prior: &LogWeights) {
        for (index, mut block) in self.blocks_mut().enumerate() {
            let first = index * BLOCK;
            block.weigh(prior, first..first + block.weights.len());
        }
    }

    /// The sums of every block.
    pub fn blocks(&self) -> &[BlockWeights] {
        &self.blocks
    }

    /// Largest ln L of a particle of positive weight.
    pub fn best_log_likelihood(&self) -> f64 {
        let best = self.blocks.iter().map(|block| block.best_log_likelihood);
        best.fold(f64::NEG_INFINITY, larger)
    }

    /// Sets every block's scale; `None` if all weights are zero.
    pub fn normalise(&mut self) -> Option<Normalisation> {
        let largest = self.blocks.iter().map(|block| block.log_factor);
        let largest = largest.fold(f64::NEG_INFINITY, larger);
        if largest == f64::NEG_INFINITY {
            return None;
        }
        let (mut sum, mut sum_of_squares) = (0.0, 0.0);
        for block in &mut self.blocks {
            block.scale = libm::exp(block.log_factor - largest);
            sum += block.scale * block.sum;
            sum_of_squares += block.scale * block.scale * block.sum_of_squares;
        }
        for block in &mut self.blocks {
            block.scale /= sum;
        }
        Some(Normalisation {
            log_sum: largest + libm::log(sum),
            effective_sample_size: sum * sum / sum_of_squares,
        })
    }
}

impl UnnormalisedBlock<'_> {
    /// Bayes' rule on the particles `range` of the set, whose likelihoods have been written.
    /// Returns their unnormalised weights.
    ///
    /// # Panics
    /// If a likelihood is NaN or +inf: then the model is broken.
    pub fn weigh(&mut self, prior: &LogWeights, range: Range<usize>) -> &[f64] {
        let (first, log_prior) = (range.start, &prior.log[range]);
        *self.sums = BlockWeights::of(first, log_prior, self.log_likelihood, self.weights);
        self.weights
    }
}

impl BlockWeights {
    /// Writes the unnormalised weights of a block whose first particle is number `first` of its
    /// set.
    fn of(
        first: usize,
        log_prior: &[f64],
        log_likelihood: &[f64],
        unnormalised: &mut [f64],
    ) -> Self {
        let best_log_likelihood = best_log_likelihood(first, log_prior, log_likelihood);
        for ((u, w), l) in unnormalised.iter_mut().zip(log_prior).zip(log_likelihood) {
            *u = w + l;
        }
        let log_factor = largest(unnormalised, unnormalised, |x, _| x);
        exponentials(unnormalised, log_factor);
        Self {
            best_log_likelihood,
            log_factor,
            sum: sum(unnormalised, |x| x),
            sum_of_squares: sum(unnormalised, |x| x * x),
            scale: 0.0,
        }
    }

    /// The factor that normalises the block's weights, once all blocks have been weighed.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}

/// The largest log-likelihood of a particle of positive weight; the first particle is number
/// `first` of its set.
///
/// # Panics
/// If a likelihood is NaN or +inf: then the model is broken.
fn best_log_likelihood(first: usize, log_weights: &[f64], log_likelihood: &[f64]) -> f64 {
    // checks all of them: a loop that may stop early does not vectorise
    let broken = log_likelihood
        .iter()
        .fold(false, |broken, &l| broken | is_broken(l));
    if broken && let Some(i) = log_likelihood.iter().position(|&l| is_broken(l)) {
        panic!(
            "the log-likelihood of particle {} is {}; it must be finite or -inf",
            first + i,
            log_likelihood[i]
        );
    }
    largest(log_weights, log_likelihood, |w, l| {
        if w > f64::NEG_INFINITY {
            l
        } else {
            f64::NEG_INFINITY
        }
    })
}

/// Returns true if `log` is no logarithm of a weight or a likelihood.
fn is_broken(log: f64) -> bool {
    log.is_nan() || log == f64::INFINITY
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The largest f(x_i, y_i), -inf at least.
fn largest(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
    let mut best = [f64::NEG_INFINITY; PARTIAL];
    let ((x, last_x), (y, last_y)) = (x.as_chunks::<PARTIAL>(), y.as_chunks::<PARTIAL>());
    for (x, y) in x.iter().zip(y) {
        for k in 0..PARTIAL {
            best[k] = larger(best[k], f(x[k], y[k]));
        }
    }
    let last = last_x.iter().zip(last_y).map(|(x, y)| f(*x, *y));
    best.into_iter().chain(last).fold(f64::NEG_INFINITY, larger)
}

/// Σ f(x_i).
fn sum(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut partial = [0.0; PARTIAL];
    let (x, last) = x.as_chunks::<PARTIAL>();
    for x in x {
        for k in 0..PARTIAL {
            partial[k] += f(x[k]);
        }
    }
    partial.into_iter().chain(last.iter().map(|x| f(*x))).sum()
}
