//! Quantities of a particle that a camera pose may move (robust model; docs/model.md (45)): all
//! that is continuous and not resampled from its prior.

use stickslip_filter::{BLOCK, Block, BlockMut};

use crate::particle::set::columns::Columns;
use crate::particle::unknown::table;

/// Scale on which a column's numbers are about normal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    Linear,
    /// For a positive number.
    Logarithm,
}

/// Least friction whose logarithm is taken: without a tripod there is no d_tri.
const LEAST: f64 = 1e-12;

/// Largest friction that a particle is moved to; the next step brings it within its limits.
const MOST: f64 = 10.0;

/// Returns the columns, each with its scale.
fn moved(columns: Columns) -> impl Iterator<Item = (usize, Scale)> {
    let past = (0..columns.history()).map(move |slot| columns.past_pose(slot));
    let poses = std::iter::once(Columns::POSE).chain(past);
    let unknowns = table::numbers(columns).filter(|number| number.of.moved);
    let linear = poses
        .flat_map(|first| first..first + 3)
        .chain(unknowns.map(|number| number.column));
    linear
        .map(|column| (column, Scale::Linear))
        .chain((0..4).map(|k| (Columns::FRICTION + k, Scale::Logarithm)))
}

/// Number of these columns.
pub(crate) fn count(columns: Columns) -> usize {
    moved(columns).count()
}

/// Reads these columns, [`BLOCK`] numbers of each.
pub(crate) fn read(columns: Columns, block: &Block<'_>, to: &mut [f64]) {
    for ((column, scale), to) in moved(columns).zip(to.chunks_mut(BLOCK)) {
        for (to, value) in to.iter_mut().zip(block.column(column)) {
            *to = match scale {
                Scale::Linear => *value,
                Scale::Logarithm => libm::log(value.max(LEAST)),
            };
        }
    }
}

/// Writes these columns back.
pub(crate) fn write(columns: Columns, from: &[f64], block: &mut BlockMut<'_>) {
    for ((column, scale), from) in moved(columns).zip(from.chunks(BLOCK)) {
        for (value, from) in block.column_mut(column).iter_mut().zip(from) {
            *value = match scale {
                Scale::Linear => *from,
                Scale::Logarithm => libm::exp(*from).min(MOST),
            };
        }
    }
}
