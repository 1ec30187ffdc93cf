//! Particles side by side: [`Column`], one number of each.

use stickslip_dynamics::Lanes;

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
