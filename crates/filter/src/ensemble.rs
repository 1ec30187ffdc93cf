//! Particles that an observation moves: [`Ensemble`], the update of the ensemble Kalman filter with
//! disturbed measurements (Burgers, van Leeuwen & Evensen 1998; docs/model.md (45)).

use stickslip_lanes::{Level, on_widest};

use crate::particles::BLOCK;
use crate::streams::Draw;

/// Independent partial sums: a single one would wait for every addition.
const PARTIAL: usize = 8;

/// Quantities that an observation may move, and their errors, as a model reads them from its
/// particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnsembleShape {
    /// Quantities that are moved, on scales on which they are about normal.
    pub quantities: usize,
    /// Errors of what is observed, whose noise is independent.
    pub errors: usize,
}

impl EnsembleShape {
    /// Columns of one block: the quantities, the errors, the standard deviations of their noise.
    pub(crate) fn columns(self) -> usize {
        self.moved() + self.errors
    }

    /// Those of them that move.
    fn moved(self) -> usize {
        self.quantities + self.errors
    }
}

/// Particles of one part of a block.
const PART: usize = 64;

/// Parts of a block.
const PARTS: usize = BLOCK / PART;

/// The quantities and errors of all particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ensemble {
    shape: EnsembleShape,
    /// `[block][column][lane]`, as in a particle set.
    values: Vec<f64>,
    /// Weighted mean by column.
    means: Vec<f64>,
    /// Covariance of each column with the error at hand, then its gain: by how much it moves where
    /// the error does by one.
    gains: Vec<f64>,
}

impl Ensemble {
    /// For so many blocks of particles.
    pub fn new(shape: EnsembleShape, blocks: usize) -> Self {
        Self {
            shape,
            values: vec![0.0; shape.columns() * blocks * BLOCK],
            means: vec![0.0; shape.moved()],
            gains: vec![0.0; shape.moved()],
        }
    }

    /// Every block's columns.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = &[f64]> + DoubleEndedIterator + Send {
        self.values.chunks(self.stride())
    }

    /// Columns of every block, to be filled.
    pub fn blocks_mut(
        &mut self,
    ) -> impl ExactSizeIterator<Item = &mut [f64]> + DoubleEndedIterator + Send {
        let stride = self.stride();
        self.values.chunks_mut(stride)
    }

    fn stride(&self) -> usize {
        self.shape.columns() * BLOCK
    }

    /// Bayes' rule for normal distributions, by the likelihood to the power `share` in (0, 1]:
    /// every particle goes its own way to a measurement disturbed by its own error. The errors'
    /// noise is independent, so that they can be taken one after the other. Particles without
    /// weight stay. The numbers of a particle's draws begin at `first`.
    pub fn update(&mut self, weights: &[f64], share: f64, (draw, first): (Draw, u32)) {
        on_widest(
            Level::new(),
            #[inline(always)]
            || {
                for k in 0..self.shape.errors {
                    self.take_means(weights);
                    self.take_gains(k, self.noise_variance(k, weights) / share, weights);
                    self.go(k, share, weights, |particle| {
                        draw.normal(particle, first + k as u32)
                    });
                }
            },
        );
    }

    /// Mean variance of the noise of one error.
    #[inline(always)]
    fn noise_variance(&self, error: usize, weights: &[f64]) -> f64 {
        let column = self.shape.moved() + error;
        let mut variance = 0.0;
        for (part, weights) in weighted(&self.values, self.stride(), weights) {
            let std = part.column(column);
            variance += sum(|i| weights[i] * std[i] * std[i]);
        }
        variance
    }

    /// Means of the columns.
    #[inline(always)]
    fn take_means(&mut self, weights: &[f64]) {
        self.means.fill(0.0);
        for (part, weights) in weighted(&self.values, self.stride(), weights) {
            for (mean, column) in self.means.iter_mut().zip(part.columns()) {
                *mean += sum(|i| weights[i] * column[i]);
            }
        }
    }

    /// Gains of all columns: by how much each moves where an error, observed under noise, moves by
    /// one.
    #[inline(always)]
    fn take_gains(&mut self, error: usize, noise_variance: f64, weights: &[f64]) {
        let stride = self.stride();
        let error = self.shape.quantities + error;
        self.gains.fill(0.0);
        for (part, weights) in weighted(&self.values, stride, weights) {
            let (errors, mean) = (part.column(error), self.means[error]);
            let e: [f64; PART] = std::array::from_fn(|i| weights[i] * (errors[i] - mean));
            let columns = part.columns().zip(&self.means);
            for (covariance, (column, mean)) in self.gains.iter_mut().zip(columns) {
                *covariance += sum(|i| (column[i] - mean) * e[i]);
            }
        }
        let observed = self.gains[error] + noise_variance;
        self.gains.iter_mut().for_each(|gain| *gain /= observed);
    }

    /// Moves all columns by their gains.
    #[inline(always)]
    fn go(&mut self, error: usize, share: f64, weights: &[f64], normal: impl Fn(u32) -> f64) {
        let (stride, columns) = (self.stride(), self.shape.moved());
        let (error, std) = (self.shape.quantities + error, columns + error);
        let scale = 1.0 / share.sqrt();
        for (index, block) in self.values.chunks_mut(stride).enumerate() {
            let block = block.as_chunks_mut::<PART>().0;
            for part in 0..PARTS {
                let number = index * PARTS + part;
                let first = (number * PART) as u32;
                let [stds, errors] = [std, error].map(|column| &block[column * PARTS + part]);
                let weights = padded(weights, number * PART);
                let way: [f64; PART] = std::array::from_fn(|i| {
                    let way = scale * stds[i] * normal(first + i as u32) - errors[i];
                    if weights[i] > 0.0 { way } else { 0.0 }
                });
                for (gain, column) in self
                    .gains
                    .iter()
                    .zip(block[part..].iter_mut().step_by(PARTS))
                {
                    for (x, way) in column.iter_mut().zip(&way) {
                        *x += gain * way;
                    }
                }
            }
        }
    }
}

/// Columns of one part of a block.
#[derive(Clone, Copy)]
struct Part<'a> {
    /// `[column][part]`.
    block: &'a [[f64; PART]],
    /// Number of the part.
    part: usize,
}

impl<'a> Part<'a> {
    #[inline(always)]
    fn columns(self) -> impl Iterator<Item = &'a [f64; PART]> {
        self.block[self.part..].iter().step_by(PARTS)
    }

    #[inline(always)]
    fn column(self, column: usize) -> &'a [f64; PART] {
        &self.block[column * PARTS + self.part]
    }
}

/// Every part of blocks of so many numbers: its columns and the weights of its particles.
#[inline(always)]
fn weighted<'a>(
    values: &'a [f64],
    stride: usize,
    weights: &'a [f64],
) -> impl Iterator<Item = (Part<'a>, [f64; PART])> {
    let parts = values.len() / stride * PARTS;
    (0..parts).map(move |number| {
        let block = &values[number / PARTS * stride..][..stride];
        let part = Part {
            block: block.as_chunks().0,
            part: number % PARTS,
        };
        (part, padded(weights, number * PART))
    })
}

/// The weights of the part that begins with particle `first`; particles past the last one have
/// none.
#[inline(always)]
fn padded(weights: &[f64], first: usize) -> [f64; PART] {
    let weights = &weights[first.min(weights.len())..];
    let mut padded = [0.0; PART];
    let count = weights.len().min(PART);
    padded[..count].copy_from_slice(&weights[..count]);
    padded
}

/// Σ f(i) over a part.
#[inline(always)]
fn sum(f: impl Fn(usize) -> f64) -> f64 {
    let mut partial = [0.0; PARTIAL];
    for i in (0..PART).step_by(PARTIAL) {
        for (k, partial) in partial.iter_mut().enumerate() {
            *partial += f(i + k);
        }
    }
    partial.iter().fold(0.0, |sum, x| sum + x)
}
