//! What of a particle the camera's pose may move where it would leave few of them (contact mode;
//! docs/method.md (45)): all that is continuous and not drawn anew.

use stickslip_filter::{BLOCK, Block, BlockMut};

use crate::particle::columns::Columns;

/// The scale on which a column's numbers are about normal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    Linear,
    /// Of a positive number.
    Logarithm,
    /// Of half the sum of squares of two normal numbers.
    Root,
}

/// Least friction whose logarithm is taken: where the feet are known, there is no d_tri.
const LEAST: f64 = 1e-12;

/// The columns, each with its scale.
fn moved(columns: Columns) -> impl Iterator<Item = (usize, Scale)> {
    let past = (0..columns.history()).map(move |slot| columns.past_pose(slot));
    let poses = std::iter::once(Columns::POSE).chain(past);
    let offset = columns.pusher_offset();
    let rig = [
        offset,
        offset + 1,
        columns.growth(),
        columns.roughness(),
        columns.force(),
    ];
    let fixels = (0..columns.fixels()).map(move |j| columns.fixel_offset(j));
    let linear = poses
        .flat_map(|first| first..first + 3)
        .chain(columns.variation()..columns.variation() + 4)
        .chain(rig)
        .chain(fixels.flat_map(|first| first..first + 2));
    linear
        .map(|column| (column, Scale::Linear))
        .chain((0..4).map(|k| (Columns::FRICTION + k, Scale::Logarithm)))
        .chain([(columns.latency(), Scale::Root)])
}

/// How many they are.
pub(super) fn count(columns: Columns) -> usize {
    moved(columns).count()
}

/// Reads them, a column of [`BLOCK`] numbers each.
pub(super) fn read(columns: Columns, block: &Block<'_>, to: &mut [f64]) {
    for ((column, scale), to) in moved(columns).zip(to.chunks_mut(BLOCK)) {
        for (to, value) in to.iter_mut().zip(block.column(column)) {
            *to = match scale {
                Scale::Linear => *value,
                Scale::Logarithm => libm::log(value.max(LEAST)),
                Scale::Root => value.sqrt(),
            };
        }
    }
}

/// Takes them back.
pub(super) fn write(columns: Columns, from: &[f64], block: &mut BlockMut<'_>) {
    for ((column, scale), from) in moved(columns).zip(from.chunks(BLOCK)) {
        for (value, from) in block.column_mut(column).iter_mut().zip(from) {
            *value = match scale {
                Scale::Linear => *from,
                Scale::Logarithm => libm::exp(*from),
                Scale::Root => from * from,
            };
        }
    }
}
