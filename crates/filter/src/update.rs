//! Bayes' rule on a set of weights, block by block: [`Update`].

use crate::BLOCK;
use crate::exponential::exponentials;

/// Numbers that are compared or added up side by side: one after the other, each would wait for the
/// one before.
const PARTIAL: usize = 8;

/// The products w L of a set, w the weights before and L the likelihoods, up to one factor in each
/// block.
#[derive(Clone, Debug)]
pub(crate) struct Update {
    products: Vec<f64>,
    blocks: Vec<BlockUpdate>,
}

/// What the products of one block come to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockUpdate {
    /// Largest ln L of a particle of positive weight.
    best_log_likelihood: f64,
    /// Largest ln w L; the block's products are relative to its exponential, which cannot overflow
    /// then.
    best: f64,
    sum: f64,
    sum_of_squares: f64,
    /// What makes normalised weights of the products.
    share: f64,
}

/// Sums over a whole set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normaliser {
    /// ln Σ w L.
    pub log_sum: f64,
    /// (Σ w L)² / Σ (w L)².
    pub effective_sample_size: f64,
}

impl Update {
    /// Of as many weights, to be filled block by block.
    pub fn new(particles: usize) -> Self {
        Self {
            products: vec![0.0; particles],
            blocks: vec![BlockUpdate::NOTHING; particles.div_ceil(BLOCK)],
        }
    }

    /// Products and sums of every block.
    pub fn blocks_mut(
        &mut self,
    ) -> impl ExactSizeIterator<Item = (&mut [f64], &mut BlockUpdate)> + DoubleEndedIterator + Send
    {
        self.products.chunks_mut(BLOCK).zip(&mut self.blocks)
    }

    /// The same of `grain` blocks at a time.
    pub fn grains(
        &self,
        grain: usize,
    ) -> impl ExactSizeIterator<Item = (&[f64], &[BlockUpdate])> + DoubleEndedIterator + Send {
        self.products
            .chunks(grain * BLOCK)
            .zip(self.blocks.chunks(grain))
    }

    /// The sums of every block.
    pub fn blocks(&self) -> &[BlockUpdate] {
        &self.blocks
    }

    /// Largest ln L of a particle of positive weight.
    pub fn best_log_likelihood(&self) -> f64 {
        self.blocks.iter().fold(f64::NEG_INFINITY, |best, block| {
            larger(best, block.best_log_likelihood)
        })
    }

    /// Settles every block's share; `None` if all products are zero.
    pub fn normalise(&mut self) -> Option<Normaliser> {
        let best = self
            .blocks
            .iter()
            .fold(f64::NEG_INFINITY, |best, block| larger(best, block.best));
        if best == f64::NEG_INFINITY {
            return None;
        }
        let (mut sum, mut sum_of_squares) = (0.0, 0.0);
        for block in &mut self.blocks {
            block.share = libm::exp(block.best - best);
            sum += block.share * block.sum;
            sum_of_squares += block.share * block.share * block.sum_of_squares;
        }
        for block in &mut self.blocks {
            block.share /= sum;
        }
        Some(Normaliser {
            log_sum: best + libm::log(sum),
            effective_sample_size: sum * sum / sum_of_squares,
        })
    }
}

impl BlockUpdate {
    const NOTHING: Self = Self {
        best_log_likelihood: f64::NEG_INFINITY,
        best: f64::NEG_INFINITY,
        sum: 0.0,
        sum_of_squares: 0.0,
        share: 0.0,
    };

    /// Writes the products of a block whose first particle is number `first` of its set.
    pub fn of(
        first: usize,
        log_weights: &[f64],
        log_likelihood: &[f64],
        products: &mut [f64],
    ) -> Self {
        let best_log_likelihood = best_alive(first, log_weights, log_likelihood);
        for ((product, w), l) in products.iter_mut().zip(log_weights).zip(log_likelihood) {
            *product = w + l;
        }
        let best = largest(products, products, |x, _| x);
        exponentials(products, best);
        Self {
            best_log_likelihood,
            best,
            sum: sum(products, |x| x),
            sum_of_squares: sum(products, |x| x * x),
            share: 0.0,
        }
    }

    /// The factor that makes normalised weights of the block's products, once [`Update::normalise`]
    /// has settled it.
    pub fn share(&self) -> f64 {
        self.share
    }
}

/// The largest log-likelihood of a particle of positive weight; the first particle is number
/// `first`.
///
/// # Panics
/// If a likelihood is NaN or +inf: then the model is broken.
pub(crate) fn best_alive(first: usize, log_weights: &[f64], log_likelihood: &[f64]) -> f64 {
    // up to the end: a loop that may stop early does not vectorise
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

/// Whether the logarithm of a weight or likelihood is none.
pub(crate) fn is_broken(log: f64) -> bool {
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
