//! Importance weights of a particle set, as natural logarithms.
//!
//! Logarithms, because a product of many sensors' likelihoods underflows. Weights are kept normalised: the linear
//! weights `w_i = exp(log w_i)` sum to 1 up to rounding, at least one is positive, none is NaN. Sums run over a
//! fixed tree, so they do not depend on threads.

use crate::exponential::exponentials;
use crate::{BLOCK, parallel};

/// Blocks of weights that one thread takes at least.
const GRAIN: usize = 16;

/// Comparisons that run side by side.
const PARTIAL: usize = 8;

/// Why weights were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightError {
    /// No weights at all.
    #[error("there are 0 weights; at least 1 is needed")]
    Empty,
    /// A weight is NaN or positive infinity.
    #[error("the log-weight of particle {particle} is NaN or +inf; it must be finite or -inf; check the likelihood")]
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
        let mut weights = LogWeights { log: vec![0.0; particles], linear: vec![0.0; particles], effective_sample_size: 0.0 };
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
        let linear = vec![0.0; log.len()];
        let mut weights = LogWeights { log, linear, effective_sample_size: 0.0 };
        weights.normalise().ok_or(WeightError::AllZero)?;
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
    /// Returns `ln sum_j w_j L_j`, the observation's log-evidence given those before it; or `None`, and leaves the
    /// weights as they were, if that sum is zero.
    ///
    /// # Panics
    /// If a likelihood is NaN or +inf: then the model is broken.
    pub fn multiply(&mut self, log_likelihood: &[f64]) -> Option<f64> {
        assert_eq!(log_likelihood.len(), self.log.len());
        assert_sound(log_likelihood);
        let mut joint = self.log.iter().zip(log_likelihood).map(|(w, l)| w + l);
        if joint.all(|w| w == f64::NEG_INFINITY) {
            return None;
        }
        parallel::for_each(&mut self.log, BLOCK, GRAIN, |block, log| {
            log.iter_mut().zip(&log_likelihood[block * BLOCK..]).for_each(|(w, l)| *w += l);
        });
        self.normalise()
    }

    /// The largest of `log_likelihood` (N,) among the particles of positive weight.
    ///
    /// # Panics
    /// If one is NaN or +inf: then the model is broken.
    pub fn best(&self, log_likelihood: &[f64]) -> f64 {
        assert_eq!(log_likelihood.len(), self.log.len());
        assert_sound(log_likelihood);
        let alive = |w: f64, l: f64| if w > f64::NEG_INFINITY { l } else { f64::NEG_INFINITY };
        largest(&self.log, log_likelihood, alive)
    }

    /// Makes the linear weights sum to 1; the logarithm of the sum before, or `None` if all weights are zero.
    fn normalise(&mut self) -> Option<f64> {
        let best = largest(&self.log, &self.log, |w, _| w);
        if best == f64::NEG_INFINITY {
            return None;
        }
        // exponentials relative to the best, which cannot overflow
        let log = &self.log;
        parallel::for_each(&mut self.linear, BLOCK, GRAIN, |block, linear| {
            exponentials(&log[block * BLOCK..][..linear.len()], best, linear);
        });
        let (sum, sum_of_squares) = sums(&self.linear);
        self.effective_sample_size = sum * sum / sum_of_squares;

        let log_sum = best + libm::log(sum);
        parallel::for_each(&mut self.linear, BLOCK, GRAIN, |_, linear| linear.iter_mut().for_each(|w| *w /= sum));
        parallel::for_each(&mut self.log, BLOCK, GRAIN, |_, log| log.iter_mut().for_each(|w| *w -= log_sum));
        Some(log_sum)
    }

    /// The effective sample size `(sum w)^2 / sum w^2` (Kong, Liu & Wong 1994): N for equal weights, 1 when one
    /// particle holds all the mass.
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

fn assert_sound(log_likelihood: &[f64]) {
    // up to the end: a loop that may stop early does not vectorise
    let broken = log_likelihood.iter().fold(false, |broken, &l| broken | is_broken(l));
    if broken && let Some(particle) = log_likelihood.iter().position(|&l| is_broken(l)) {
        let value = log_likelihood[particle];
        panic!("the log-likelihood of particle {particle} is {value}; it must be finite or -inf");
    }
}

fn is_broken(log_weight: f64) -> bool {
    log_weight.is_nan() || log_weight == f64::INFINITY
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The largest f(x_i, y_i), -inf at least.
fn largest(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
    let of = |block: usize| {
        let range = block * BLOCK..x.len().min((block + 1) * BLOCK);
        largest_of_block(&x[range.clone()], &y[range], &f)
    };
    parallel::tree_reduce(0..x.len().div_ceil(BLOCK), &of, &larger)
}

/// In [`PARTIAL`] partial ones: one would wait for every comparison.
fn largest_of_block(x: &[f64], y: &[f64], f: impl Fn(f64, f64) -> f64) -> f64 {
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

/// (sum x, sum x^2) over the fixed tree of blocks.
fn sums(x: &[f64]) -> (f64, f64) {
    let leaf = |block: usize| {
        let end = x.len().min((block + 1) * BLOCK);
        x[block * BLOCK..end].iter().fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w))
    };
    parallel::tree_reduce(0..x.len().div_ceil(BLOCK), &leaf, &|a, b| (a.0 + b.0, a.1 + b.1))
}
