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

/// Groups of particles, each of which goes by what the others say: a particle that had a part in its own
/// gain would go too near to the measurement, and all of them would end too close together (Houtekamer &
/// Mitchell 1998). Descendants of one particle lie side by side, mostly in one group. Of fewer blocks there
/// are as many groups; one group goes by itself.
const GROUPS: usize = 8;

/// Effective number of other particles below which a group goes by all.
const FEWEST: f64 = 10.0;

/// The quantities and errors of all particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ensemble {
    shape: EnsembleShape,
    /// `[block][column][lane]`, as in a particle set.
    values: Vec<f64>,
    /// Weighted mean by column.
    means: Vec<f64>,
    /// `[group][column]`.
    sums: Vec<Sums>,
    /// `[group][column]`: by how much a column moves where the error does by one.
    gains: Vec<f64>,
}

/// Of some particles: sums of the weights w and their squares, and of one column's distances x from its
/// mean, with the distances e of one error from its own.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    w: f64,
    ww: f64,
    x: f64,
    xx: f64,
    xe: f64,
}

impl Ensemble {
    /// For so many blocks of particles.
    pub fn new(shape: EnsembleShape, blocks: usize) -> Self {
        let groups = blocks.min(GROUPS);
        Self {
            shape,
            values: vec![0.0; shape.columns() * blocks * BLOCK],
            means: vec![0.0; shape.moved()],
            sums: vec![Sums::default(); shape.moved() * groups],
            gains: vec![0.0; shape.moved() * groups],
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
        for k in 0..self.shape.errors {
            self.take_sums(k, weights);
            self.take_gains(k, self.noise_variance(k, weights) / share);
            self.go(k, share, |particle| draw.normal(particle, k as u32));
        }
    }

    /// Mean variance of the noise of one error.
    fn noise_variance(&self, error: usize, weights: &[f64]) -> f64 {
        let column = self.shape.moved() + error;
        let blocks = self.blocks().zip(weights.chunks(BLOCK));
        let of_blocks = blocks.map(|(block, weights)| {
            let (weights, std) = (padded(weights), &block.as_chunks::<BLOCK>().0[column]);
            sum(|i| weights[i] * std[i] * std[i])
        });
        of_blocks.fold(0.0, |sum, x| sum + x)
    }

    /// Weighted sums of all columns, with one error, group by group.
    fn take_sums(&mut self, error: usize, weights: &[f64]) {
        let (stride, columns) = (self.stride(), self.shape.moved());
        let error = self.shape.quantities + error;
        let Self {
            values,
            means,
            sums,
            ..
        } = self;
        let count = values.len() / stride;
        let blocks = || {
            let blocks = values.chunks(stride).zip(weights.chunks(BLOCK));
            blocks.map(|(block, weights)| (block.as_chunks::<BLOCK>().0, padded(weights)))
        };
        means.fill(0.0);
        for (block, weights) in blocks() {
            for (mean, column) in means.iter_mut().zip(block) {
                *mean += sum(|i| weights[i] * column[i]);
            }
        }
        sums.fill(Sums::default());
        for (index, (block, weights)) in blocks().enumerate() {
            let e: [f64; BLOCK] = std::array::from_fn(|i| block[error][i] - means[error]);
            let (w, ww) = (sum(|i| weights[i]), sum(|i| weights[i] * weights[i]));
            let sums = &mut sums[group(index, count) * columns..][..columns];
            for ((of, column), mean) in sums.iter_mut().zip(block).zip(&*means) {
                of.w += w;
                of.ww += ww;
                of.x += sum(|i| weights[i] * (column[i] - mean));
                of.xx += sum(|i| weights[i] * (column[i] - mean) * (column[i] - mean));
                of.xe += sum(|i| weights[i] * (column[i] - mean) * e[i]);
            }
        }
    }

    /// Every group's gains, by the sums of the others.
    fn take_gains(&mut self, error: usize, noise_variance: f64) {
        let columns = self.shape.moved();
        let error = self.shape.quantities + error;
        for group in 0..self.sums.len() / columns {
            let observed = self.sums_of_others(group, error);
            for column in 0..columns {
                let of = self.sums_of_others(group, column);
                let certain = column >= self.shape.quantities;
                self.gains[group * columns + column] =
                    gain(&of, &observed, noise_variance, certain);
            }
        }
    }

    /// Sums of one column over all groups but one, or over all where the others are too few.
    fn sums_of_others(&self, group: usize, column: usize) -> Sums {
        let of_groups = self.sums.iter().skip(column).step_by(self.shape.moved());
        let others = of_groups.clone().enumerate().filter(|(k, _)| *k != group);
        let others = others.fold(Sums::default(), |all, (_, group)| all.with(group));
        if others.count() < FEWEST {
            return of_groups.fold(Sums::default(), Sums::with);
        }
        others
    }

    /// Moves all columns by their gains.
    fn go(&mut self, error: usize, share: f64, normal: impl Fn(u32) -> f64) {
        let (stride, columns) = (self.stride(), self.shape.moved());
        let (error, std) = (self.shape.quantities + error, columns + error);
        let scale = 1.0 / share.sqrt();
        let count = self.values.len() / stride;
        for (index, block) in self.values.chunks_mut(stride).enumerate() {
            let gains = &self.gains[group(index, count) * columns..][..columns];
            let block = block.as_chunks_mut::<BLOCK>().0;
            let first = (index * BLOCK) as u32;
            let way: [f64; BLOCK] = std::array::from_fn(|i| {
                scale * block[std][i] * normal(first + i as u32) - block[error][i]
            });
            for (gain, column) in gains.iter().zip(block) {
                for (x, way) in column.iter_mut().zip(&way) {
                    *x += gain * way;
                }
            }
        }
    }
}

impl Sums {
    /// The same of more particles.
    fn with(self, others: &Self) -> Self {
        Self {
            w: self.w + others.w,
            ww: self.ww + others.ww,
            x: self.x + others.x,
            xx: self.xx + others.xx,
            xe: self.xe + others.xe,
        }
    }

    /// Effective number of particles; 0 where they have no weight.
    fn count(&self) -> f64 {
        if self.ww > 0.0 {
            self.w * self.w / self.ww
        } else {
            0.0
        }
    }
}

/// The group of a block.
fn group(block: usize, blocks: usize) -> usize {
    block * blocks.min(GROUPS) / blocks
}

/// By how much a column moves where an error does by one that is observed under noise; a covariance that
/// is not `certain` counts only by the share that is not chance.
fn gain(of: &Sums, error: &Sums, noise_variance: f64, certain: bool) -> f64 {
    let (x, e) = (of.x / of.w, error.x / of.w);
    let variance = of.xx / of.w - x * x;
    let observed = error.xx / of.w - e * e;
    let covariance = of.xe / of.w - x * e;
    let share = match certain {
        true => 1.0,
        false => not_chance(covariance, variance * observed, of.count()),
    };
    share * covariance / (observed + noise_variance)
}

/// Share of a covariance that is not chance: of `count` independent particles, two columns that have
/// nothing to do with each other have a squared correlation of 1 / `count` (Anderson 2012). 0 to 1;
/// `product` is that of their variances.
fn not_chance(covariance: f64, product: f64, count: f64) -> f64 {
    let square = covariance * covariance;
    if square <= 0.0 || product <= 0.0 {
        return 0.0;
    }
    let chance = (product - square).max(0.0) / count;
    (1.0 - chance / square).max(0.0)
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
