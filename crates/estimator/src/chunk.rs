//! Particles side by side: [`Column`], one number of each.

use stickslip_dynamics::{Lanes, Mask};
use stickslip_filter::{Block, BlockMut};

use crate::columns::Flag;

/// Particles of a chunk.
pub(crate) const LANES: usize = 8;

/// One number of each particle of a chunk.
pub(crate) type Column = Lanes<LANES>;

/// Chunk `chunk` of a column; `past` beyond its end.
#[inline(always)]
pub(crate) fn part(column: &[f64], chunk: usize, past: f64) -> Column {
    let rest = &column[chunk * LANES..];
    match rest.first_chunk() {
        Some(lanes) => Lanes(*lanes),
        None => last_part(rest, past),
    }
}

/// Overwrites chunk `chunk` of a column.
#[inline(always)]
pub(crate) fn store_part(column: &mut [f64], chunk: usize, from: &Column) {
    let rest = &mut column[chunk * LANES..];
    match rest.first_chunk_mut() {
        Some(lanes) => *lanes = from.0,
        None => store_last_part(rest, from),
    }
}

/// Where a flag is set in chunk `chunk`.
#[inline(always)]
pub(crate) fn flag(block: &Block<'_>, Flag { column, bit }: Flag, chunk: usize) -> Mask<LANES> {
    let bits = part(block.column(column), chunk, 0.0);
    Mask::from_fn(
        #[inline(always)]
        |lane| bits.0[lane].to_bits() >> bit & 1 == 1,
    )
}

/// Sets a flag in the lanes of `yes` of chunk `chunk`, and clears it in the others.
#[inline(always)]
pub(crate) fn store_flag(block: &mut BlockMut<'_>, Flag { column, bit }: Flag, chunk: usize, yes: Mask<LANES>) {
    let column = block.column_mut(column);
    let mut bits = part(column, chunk, 0.0);
    for (lane, bits) in bits.0.iter_mut().enumerate() {
        *bits = f64::from_bits(bits.to_bits() & !(1 << bit) | u64::from(yes.lane(lane)) << bit);
    }
    store_part(column, chunk, &bits);
}

/// Out of line: beside it, a whole chunk would be copied by a call with a number of bytes.
#[cold]
#[inline(never)]
fn last_part(rest: &[f64], past: f64) -> Column {
    let mut part = Column::splat(past);
    part.0[..rest.len()].copy_from_slice(rest);
    part
}

/// See [`last_part`].
#[cold]
#[inline(never)]
fn store_last_part(rest: &mut [f64], from: &Column) {
    rest.copy_from_slice(&from.0[..rest.len()]);
}
