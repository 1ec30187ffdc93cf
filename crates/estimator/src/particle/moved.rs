//! Quantities of a particle that a camera pose may move (robust model; docs/method.md (45)): all
//! that is continuous and not resampled from its prior.

use stickslip_filter::{BLOCK, Block, BlockMut};

use crate::particle::columns::Columns;

/// Scale on which a column's numbers are about normal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    Linear,
    /// For a positive number.
    Logarithm,
    /// For an exponential number. Its fourth root is about normal: Weibull's distribution of shape
    /// 4 has the skewness −0.09. Its square root has 0.63.
    FourthRoot,
}

/// Least friction whose logarithm is taken: without a tripod there is no d_tri.
const LEAST: f64 = 1e-12;

/// Largest friction that a particle is moved to; the next step brings it within its limits.
const MOST: f64 = 10.0;

/// Returns the columns, each with its scale.
fn moved(columns: Columns) -> impl Iterator<Item = (usize, Scale)> {
    let past = (0..columns.history()).map(move |slot| columns.past_pose(slot));
    let poses = std::iter::once(Columns::POSE).chain(past);
    let offset = columns.pusher_offset();
    let rig = [
        offset,
        offset + 1,
        columns.pusher_turn(),
        columns.growth(),
        columns.force(),
        columns.creep(),
        columns.creep() + 1,
    ];
    let support = columns.support()..columns.support() + 3;
    let fixels = (0..columns.fixels()).map(move |j| columns.fixel_offset(j));
    let linear = poses
        .flat_map(|first| first..first + 3)
        .chain(columns.variation()..columns.variation() + 4)
        .chain(rig)
        .chain(support)
        .chain(fixels.flat_map(|first| first..first + 2));
    linear
        .map(|column| (column, Scale::Linear))
        .chain((0..4).map(|k| (Columns::FRICTION + k, Scale::Logarithm)))
        .chain([(columns.latency(), Scale::FourthRoot)])
}

/// Number of these columns.
pub(super) fn count(columns: Columns) -> usize {
    moved(columns).count()
}

/// Reads these columns, [`BLOCK`] numbers of each.
pub(super) fn read(columns: Columns, block: &Block<'_>, to: &mut [f64]) {
    for ((column, scale), to) in moved(columns).zip(to.chunks_mut(BLOCK)) {
        for (to, value) in to.iter_mut().zip(block.column(column)) {
            *to = match scale {
                Scale::Linear => *value,
                Scale::Logarithm => libm::log(value.max(LEAST)),
                Scale::FourthRoot => value.sqrt().sqrt(),
            };
        }
    }
}

/// Writes these columns back.
pub(super) fn write(columns: Columns, from: &[f64], block: &mut BlockMut<'_>) {
    for ((column, scale), from) in moved(columns).zip(from.chunks(BLOCK)) {
        for (value, from) in block.column_mut(column).iter_mut().zip(from) {
            *value = match scale {
                Scale::Linear => *from,
                Scale::Logarithm => libm::exp(*from).min(MOST),
                Scale::FourthRoot => (from * from) * (from * from),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter_model::FilterModel;
    use stickslip_filter::{ParticleSet, Streams};

    const PARTICLES: usize = 64 * BLOCK;

    /// Latencies as the prior draws them: half the sum of squares of two normal numbers.
    fn drawn(columns: Columns) -> ParticleSet {
        let mut particles = ParticleSet::zeros(PARTICLES, columns.count());
        particles.for_each_block(|block| {
            for (i, particle) in block.particles() {
                let [a, b] = Streams::new(1).normals::<2>(0, particle, 0);
                block.column_mut(columns.latency())[i] = 0.03 * 0.5 * (a * a + b * b);
            }
        });
        particles
    }

    /// A normal number has skewness 0 and excess kurtosis 0. The scale on which the latency is
    /// moved comes near (Weibull's distribution of shape 4: −0.087 and −0.252; the square root has
    /// 0.631 and 0.245).
    #[test]
    fn latencies_as_likely_as_the_prior_says_are_moved_as_about_normal_numbers() {
        let columns = Columns::new(FilterModel::Robust, 0, 0);
        let which = moved(columns).position(|(column, _)| column == columns.latency());
        let which = which.expect("latency is moved");
        let mut numbers = Vec::new();
        let mut to = vec![0.0; count(columns) * BLOCK];
        for block in drawn(columns).blocks() {
            read(columns, &block, &mut to);
            numbers.extend_from_slice(&to[which * BLOCK..][..block.len()]);
        }
        let moment = |centre: f64, power: i32| {
            let sum: f64 = numbers.iter().map(|x| (x - centre).powi(power)).sum();
            sum / numbers.len() as f64
        };
        let mean = moment(0.0, 1);
        let variance = moment(mean, 2);
        let skewness = moment(mean, 3) / (variance * variance.sqrt());
        let kurtosis = moment(mean, 4) / (variance * variance) - 3.0;
        // standard errors over 4096 numbers: 0.04 and 0.08
        assert!((skewness + 0.087).abs() < 0.12, "{skewness}");
        assert!((kurtosis + 0.252).abs() < 0.24, "{kurtosis}");
    }

    #[test]
    fn what_is_not_moved_comes_back() {
        let columns = Columns::new(FilterModel::Robust, 0, 0);
        let mut particles = drawn(columns);
        let before: Vec<f64> = particles.column(columns.latency()).collect();
        particles.for_each_block(|block| {
            let mut numbers = vec![0.0; count(columns) * BLOCK];
            read(columns, &block.as_block(), &mut numbers);
            write(columns, &numbers, block);
        });
        for (before, after) in before.iter().zip(particles.column(columns.latency())) {
            assert!((after - before).abs() < 1e-14 * before, "{before}, {after}");
        }
    }
}
