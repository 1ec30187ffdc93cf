//! Particles that an observation moves: [`Ensemble`], the update of the ensemble Kalman filter with
//! disturbed measurements (Burgers, van Leeuwen & Evensen 1998; docs/method.md (45)).

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

/// Number of groups of particles; the gain of each comes from the other groups. A particle with a
/// part in its own gain would go too near to the measurement, and all would end too close together
/// (Houtekamer & Mitchell 1998).
///
/// Descendants of one particle lie side by side, mostly in one group. If there are fewer parts of
/// blocks, there are as many groups as parts. A single group uses its own gain.
const GROUPS: usize = 8;

/// Particles of one part of a block; a group is some parts.
const PART: usize = 64;

/// Parts of a block.
const PARTS: usize = BLOCK / PART;

/// Effective number of other particles below which a group goes by all.
const FEWEST: f64 = 10.0;

/// The quantities and errors of all particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ensemble {
    shape: EnsembleShape,
    /// `[block][column][lane]`, as in a particle set.
    values: Vec<f64>,
    /// Weighted mean by column, before the first error.
    means: Vec<f64>,
    /// By group.
    weights: Vec<Weight>,
    /// `[group][column]`.
    sums: Vec<Sums>,
    /// By column, of all groups but one.
    others: Vec<Sums>,
    /// `[group][column]`: by how much a column moves where the error does by one.
    gains: Vec<f64>,
}

/// Sums of the weights of some particles and of their squares.
#[derive(Clone, Copy, Debug, Default)]
struct Weight {
    w: f64,
    ww: f64,
}

/// Of some particles: weighted sums of one column's distances x from its mean, with the distances e
/// of one error from its own. Any point near them would do as the mean.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    x: f64,
    xx: f64,
    xe: f64,
}

impl Ensemble {
    /// For so many blocks of particles.
    pub fn new(shape: EnsembleShape, blocks: usize) -> Self {
        let groups = (blocks * PARTS).min(GROUPS);
        Self {
            shape,
            values: vec![0.0; shape.columns() * blocks * BLOCK],
            means: vec![0.0; shape.moved()],
            weights: vec![Weight::default(); groups],
            sums: vec![Sums::default(); shape.moved() * groups],
            others: vec![Sums::default(); shape.moved()],
            gains: vec![0.0; shape.moved() * groups],
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
                self.weigh(weights);
                for k in 0..self.shape.errors {
                    self.take_sums(k, weights);
                    self.take_gains(k, self.noise_variance(k, weights) / share);
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
        for (_, part, weights) in weighted(&self.values, self.stride(), weights) {
            let std = part.column(column);
            variance += sum(|i| weights[i] * std[i] * std[i]);
        }
        variance
    }

    /// Weights of the groups, means of the columns.
    #[inline(always)]
    fn weigh(&mut self, weights: &[f64]) {
        self.means.fill(0.0);
        self.weights.fill(Weight::default());
        for (group, part, weights) in weighted(&self.values, self.stride(), weights) {
            let of = &mut self.weights[group];
            of.w += sum(|i| weights[i]);
            of.ww += sum(|i| weights[i] * weights[i]);
            for (mean, column) in self.means.iter_mut().zip(part.columns()) {
                *mean += sum(|i| weights[i] * column[i]);
            }
        }
    }

    /// Weighted sums of all columns, with one error, group by group.
    #[inline(always)]
    fn take_sums(&mut self, error: usize, weights: &[f64]) {
        let (stride, columns) = (self.stride(), self.shape.moved());
        let error = self.shape.quantities + error;
        self.sums.fill(Sums::default());
        for (group, part, weights) in weighted(&self.values, stride, weights) {
            let (errors, mean) = (part.column(error), self.means[error]);
            let e: [f64; PART] = std::array::from_fn(|i| errors[i] - mean);
            let sums = &mut self.sums[group * columns..][..columns];
            for ((of, column), mean) in sums.iter_mut().zip(part.columns()).zip(&self.means) {
                of.x += sum(|i| weights[i] * (column[i] - mean));
                of.xx += sum(|i| weights[i] * (column[i] - mean) * (column[i] - mean));
                of.xe += sum(|i| weights[i] * (column[i] - mean) * e[i]);
            }
        }
    }

    /// Every group's gains, by the sums of the others, or by all where the others are too few.
    #[inline(always)]
    fn take_gains(&mut self, error: usize, noise_variance: f64) {
        let columns = self.shape.moved();
        let error = self.shape.quantities + error;
        for (group, gains) in self.gains.chunks_mut(columns).enumerate() {
            let mut weight = Weight::default();
            let others = self.weights.iter().enumerate().filter(|(k, _)| *k != group);
            others.for_each(|(_, other)| weight.add(other));
            let all = weight.count() < FEWEST;
            if all {
                weight.add(&self.weights[group]);
            }
            self.others.fill(Sums::default());
            for (k, sums) in self.sums.chunks(columns).enumerate() {
                if all || k != group {
                    let to = self.others.iter_mut().zip(sums);
                    to.for_each(|(to, sums)| to.add(sums));
                }
            }
            let observed = self.others[error];
            for (column, (gain, of)) in gains.iter_mut().zip(&self.others).enumerate() {
                let certain = column >= self.shape.quantities;
                *gain = gain_by(&weight, of, &observed, noise_variance, certain);
            }
        }
    }

    /// Moves all columns by their gains.
    #[inline(always)]
    fn go(&mut self, error: usize, share: f64, weights: &[f64], normal: impl Fn(u32) -> f64) {
        let (stride, columns) = (self.stride(), self.shape.moved());
        let (error, std) = (self.shape.quantities + error, columns + error);
        let scale = 1.0 / share.sqrt();
        let count = self.values.len() / stride;
        for (index, block) in self.values.chunks_mut(stride).enumerate() {
            let block = block.as_chunks_mut::<PART>().0;
            for part in 0..PARTS {
                let number = index * PARTS + part;
                let gains = &self.gains[group(number, count * PARTS) * columns..][..columns];
                let first = (number * PART) as u32;
                let [stds, errors] = [std, error].map(|column| &block[column * PARTS + part]);
                let weights = padded(weights, number * PART);
                let way: [f64; PART] = std::array::from_fn(|i| {
                    let way = scale * stds[i] * normal(first + i as u32) - errors[i];
                    if weights[i] > 0.0 { way } else { 0.0 }
                });
                for (gain, column) in gains.iter().zip(block[part..].iter_mut().step_by(PARTS)) {
                    for (x, way) in column.iter_mut().zip(&way) {
                        *x += gain * way;
                    }
                }
            }
        }
    }
}

impl Weight {
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.w += other.w;
        self.ww += other.ww;
    }

    /// Effective number of particles; 0 where they have no weight.
    #[inline(always)]
    fn count(&self) -> f64 {
        if self.ww > 0.0 {
            self.w * self.w / self.ww
        } else {
            0.0
        }
    }
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.x += other.x;
        self.xx += other.xx;
        self.xe += other.xe;
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

/// The group of a part.
#[inline(always)]
fn group(part: usize, parts: usize) -> usize {
    part * parts.min(GROUPS) / parts
}

/// Gain: the motion of a column where an error that is observed under noise moves by one. A
/// covariance that is not `certain` counts only by the share that is not chance.
#[inline(always)]
fn gain_by(weight: &Weight, of: &Sums, error: &Sums, noise_variance: f64, certain: bool) -> f64 {
    let (x, e) = (of.x / weight.w, error.x / weight.w);
    let variance = of.xx / weight.w - x * x;
    let observed = error.xx / weight.w - e * e;
    let covariance = of.xe / weight.w - x * e;
    let share = match certain {
        true => 1.0,
        false => not_chance(covariance, variance * observed, weight.count()),
    };
    share * covariance / (observed + noise_variance)
}

/// Share of a covariance that is not chance: of `count` independent particles, two columns that
/// have nothing to do with each other have a squared correlation of 1 / `count` (Anderson 2012). 0
/// to 1; `product` is that of their variances.
#[inline(always)]
fn not_chance(covariance: f64, product: f64, count: f64) -> f64 {
    let square = covariance * covariance;
    if square <= 0.0 || product <= 0.0 {
        return 0.0;
    }
    let chance = (product - square).max(0.0) / count;
    (1.0 - chance / square).max(0.0)
}

/// Every part of blocks of so many numbers: its group, its columns and the weights of its
/// particles.
#[inline(always)]
fn weighted<'a>(
    values: &'a [f64],
    stride: usize,
    weights: &'a [f64],
) -> impl Iterator<Item = (usize, Part<'a>, [f64; PART])> {
    let parts = values.len() / stride * PARTS;
    (0..parts).map(move |number| {
        let block = &values[number / PARTS * stride..][..stride];
        let part = Part {
            block: block.as_chunks().0,
            part: number % PARTS,
        };
        (group(number, parts), part, padded(weights, number * PART))
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
