//! Particles that an observation moves: [`Ensemble`], the update of the ensemble Kalman filter with
//! disturbed measurements (Burgers, van Leeuwen & Evensen 1998; docs/method.md (45)).

use crate::particles::BLOCK;
use crate::streams::Draw;

/// Independent partial sums: a single one would wait for every addition.
const PARTIAL: usize = 8;

/// What an observation may move, as a model reads it from its particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnsembleShape {
    /// Quantities that are moved, on scales on which they are about normal.
    pub quantities: usize,
    /// Errors of what is observed, independent and of variance 1.
    pub errors: usize,
}

impl EnsembleShape {
    /// Columns of one block: the quantities, then the errors.
    pub(crate) fn columns(self) -> usize {
        self.quantities + self.errors
    }
}

/// The quantities and errors of all particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ensemble {
    shape: EnsembleShape,
    /// `[block][column][lane]`, as in a particle set.
    values: Vec<f64>,
    /// By column: weighted mean, variance, and covariance with one error.
    moments: Vec<Moments>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    mean: f64,
    variance: f64,
    covariance: f64,
}

impl Ensemble {
    /// For so many blocks of particles.
    pub fn new(shape: EnsembleShape, blocks: usize) -> Self {
        Self {
            shape,
            values: vec![0.0; shape.columns() * blocks * BLOCK],
            moments: vec![Moments::default(); shape.columns()],
        }
    }

    /// Every block's columns.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = &[f64]> + DoubleEndedIterator + Send {
        self.values.chunks(self.stride())
    }

    /// The same, to be filled.
    pub fn blocks_mut(
        &mut self,
    ) -> impl ExactSizeIterator<Item = &mut [f64]> + DoubleEndedIterator + Send {
        let stride = self.stride();
        self.values.chunks_mut(stride)
    }

    fn stride(&self) -> usize {
        self.shape.columns() * BLOCK
    }

    /// Bayes' rule for normal distributions, by the likelihood to the power `share` in (0, 1]: every
    /// particle goes its own way to a measurement disturbed by its own error. The errors' noise is
    /// independent, so that they can be taken one after the other.
    pub fn update(&mut self, weights: &[f64], share: f64, draw: Draw) {
        let noise = 1.0 / share;
        let count = 1.0 / weights.iter().fold(0.0, |sum, w| sum + w * w);
        for k in 0..self.shape.errors {
            let error = self.shape.quantities + k;
            self.take_moments(error, weights);
            let observed = self.moments[error].variance;
            for (j, of) in self.moments.iter_mut().enumerate() {
                let kept = match j < self.shape.quantities {
                    true => of.certain(observed, count),
                    false => 1.0,
                };
                of.covariance *= kept / (observed + noise);
            }
            self.go(error, noise.sqrt(), |particle| {
                draw.normal(particle, k as u32)
            });
        }
    }

    /// Weighted moments of all columns, with one error.
    fn take_moments(&mut self, error: usize, weights: &[f64]) {
        let stride = self.stride();
        let Self {
            values, moments, ..
        } = self;
        moments.fill(Moments::default());
        let blocks = || values.chunks(stride).zip(weights.chunks(BLOCK));
        for (block, weights) in blocks() {
            let weights = padded(weights);
            for (of, column) in moments.iter_mut().zip(block.as_chunks::<BLOCK>().0) {
                of.mean += sum(|i| weights[i] * column[i]);
            }
        }
        let observed = moments[error].mean;
        for (block, weights) in blocks() {
            let weights = padded(weights);
            let columns = block.as_chunks::<BLOCK>().0;
            let away: [f64; BLOCK] = std::array::from_fn(|i| columns[error][i] - observed);
            for (of, column) in moments.iter_mut().zip(columns) {
                let mean = of.mean;
                of.variance += sum(|i| weights[i] * (column[i] - mean) * (column[i] - mean));
                of.covariance += sum(|i| weights[i] * (column[i] - mean) * away[i]);
            }
        }
    }

    /// Moves all columns by their gains, which are in the place of the covariances.
    fn go(&mut self, error: usize, std: f64, normal: impl Fn(u32) -> f64) {
        let stride = self.stride();
        for (index, block) in self.values.chunks_mut(stride).enumerate() {
            let columns = block.as_chunks_mut::<BLOCK>().0;
            let first = (index * BLOCK) as u32;
            let way: [f64; BLOCK] =
                std::array::from_fn(|i| std * normal(first + i as u32) - columns[error][i]);
            for (of, column) in self.moments.iter().zip(columns) {
                for (x, way) in column.iter_mut().zip(&way) {
                    *x += of.covariance * way;
                }
            }
        }
    }
}

impl Moments {
    /// Share of a covariance that is not chance: of `count` independent particles, two columns that have
    /// nothing to do with each other have a squared correlation of 1 / `count` (Anderson 2012). 0 to 1.
    fn certain(&self, observed: f64, count: f64) -> f64 {
        let product = self.variance * observed;
        let square = self.covariance * self.covariance;
        if square <= 0.0 || product <= 0.0 {
            return 0.0;
        }
        let chance = (product - square).max(0.0) / count;
        (1.0 - chance / square).max(0.0)
    }
}

/// The weights of one block; particles past the last one have none.
fn padded(weights: &[f64]) -> [f64; BLOCK] {
    let mut padded = [0.0; BLOCK];
    padded[..weights.len()].copy_from_slice(weights);
    padded
}

/// Σ f(i) over a block.
fn sum(f: impl Fn(usize) -> f64) -> f64 {
    let mut partial = [0.0; PARTIAL];
    for i in (0..BLOCK).step_by(PARTIAL) {
        for (k, partial) in partial.iter_mut().enumerate() {
            *partial += f(i + k);
        }
    }
    partial.iter().fold(0.0, |sum, x| sum + x)
}
