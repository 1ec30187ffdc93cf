//! Particles side by side: [`Column`], one number of each.

use stickslip_dynamics::{Lanes, Mask};
use stickslip_filter::{Block, BlockMut};

use crate::columns::{Columns, Flag};

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
pub(crate) fn flag(block: &Block<'_>, which: Flag, chunk: usize) -> Mask<LANES> {
    set_in(&part(block.column(which.column), chunk, 0.0), which)
}

/// Where a flag is set in the numbers of its column.
#[inline(always)]
fn set_in(bits: &Column, Flag { bit, .. }: Flag) -> Mask<LANES> {
    Mask::from_fn(
        #[inline(always)]
        |lane| bits.0[lane].to_bits() >> bit & 1 == 1,
    )
}

/// The flags of one chunk while they change: written to the block a column at a time.
pub(crate) struct FlagsMut<'a, 'b> {
    block: &'a mut BlockMut<'b>,
    chunk: usize,
    /// The column at hand, and its numbers.
    column: usize,
    bits: Column,
}

impl<'a, 'b> FlagsMut<'a, 'b> {
    /// Those of chunk `chunk`.
    #[inline(always)]
    pub fn new(block: &'a mut BlockMut<'b>, chunk: usize) -> Self {
        let column = Columns::UNSOLVED.column;
        let bits = part(block.column(column), chunk, 0.0);
        Self {
            block,
            chunk,
            column,
            bits,
        }
    }

    /// Where a flag is set.
    #[inline(always)]
    pub fn get(&mut self, flag: Flag) -> Mask<LANES> {
        self.go_to(flag.column);
        set_in(&self.bits, flag)
    }

    /// Sets a flag in the lanes of `yes`, and clears it in the others.
    #[inline(always)]
    pub fn set(&mut self, flag: Flag, yes: Mask<LANES>) {
        self.go_to(flag.column);
        for (lane, bits) in self.bits.0.iter_mut().enumerate() {
            *bits = f64::from_bits(
                bits.to_bits() & !(1 << flag.bit) | u64::from(yes.lane(lane)) << flag.bit,
            );
        }
    }

    #[inline(always)]
    fn go_to(&mut self, column: usize) {
        if column != self.column {
            self.write();
            self.bits = part(self.block.column(column), self.chunk, 0.0);
            self.column = column;
        }
    }

    /// Writes the column at hand: the last thing to be done.
    #[inline(always)]
    pub fn write(&mut self) {
        store_part(self.block.column_mut(self.column), self.chunk, &self.bits);
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
