//! Particles side by side: [`Column`], one number of each.

use stickslip_dynamics::{Lanes, Mask, Pose};
use stickslip_filter::{Block, BlockMut};

use crate::particle::set::columns::{Columns, Flag};

/// Square of the length of a vector.
#[inline(always)]
pub(crate) fn squared([x, y]: [Column; 2]) -> Column {
    x * x + y * y
}

/// Number of particles of a chunk.
pub(crate) const LANES: usize = 8;

/// One number of each particle of a chunk.
pub(crate) type Column = Lanes<LANES>;

/// Loads chunk `chunk` of a column; lanes beyond its end are `past`.
#[inline(always)]
pub(crate) fn load_chunk(column: &[f64], chunk: usize, past: f64) -> Column {
    let rest = &column[chunk * LANES..];
    match rest.first_chunk() {
        Some(lanes) => Lanes(*lanes),
        None => last_chunk(rest, past),
    }
}

/// Overwrites chunk `chunk` of a column.
#[inline(always)]
pub(crate) fn store_chunk(column: &mut [f64], chunk: usize, from: &Column) {
    let rest = &mut column[chunk * LANES..];
    match rest.first_chunk_mut() {
        Some(lanes) => *lanes = from.0,
        None => store_last_chunk(rest, from),
    }
}

/// Adds to chunk `chunk` of a column.
#[inline(always)]
pub(crate) fn add_chunk(column: &mut [f64], chunk: usize, more: Column) {
    let so_far = load_chunk(column, chunk, 0.0);
    store_chunk(column, chunk, &(so_far + more));
}

/// Loads chunk `chunk` of three neighbouring columns, a pose.
#[inline(always)]
pub(crate) fn load_pose(block: &Block<'_>, first_column: usize, chunk: usize) -> Pose<Column> {
    // field by field: an array made by a closure is made by baseline code, and copied
    Pose {
        x: load_chunk(block.column(first_column), chunk, 0.0),
        y: load_chunk(block.column(first_column + 1), chunk, 0.0),
        theta: load_chunk(block.column(first_column + 2), chunk, 0.0),
    }
}

/// Returns the sum over the lanes.
#[inline(always)]
pub(crate) fn total(lanes: Column) -> f64 {
    lanes.0.iter().sum()
}

/// Returns the lanes of chunk `chunk` in which a flag is set.
#[inline(always)]
pub(crate) fn flag(block: &Block<'_>, which: Flag, chunk: usize) -> Mask<LANES> {
    set_in(&load_chunk(block.column(which.column), chunk, 0.0), which)
}

/// Returns true if a flag of one particle is set.
#[inline(always)]
pub(crate) fn is_set(block: &Block<'_>, Flag { column, bit }: Flag, i: usize) -> bool {
    block.column(column)[i].to_bits() >> bit & 1 == 1
}

/// Returns the lanes in which a flag is set in the numbers of its column.
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
    /// The current column, and its numbers.
    column: usize,
    bits: Column,
}

impl<'a, 'b> FlagsMut<'a, 'b> {
    /// The flags of chunk `chunk`.
    #[inline(always)]
    pub fn new(block: &'a mut BlockMut<'b>, chunk: usize) -> Self {
        let column = Columns::UNSOLVED.column;
        let bits = load_chunk(block.column(column), chunk, 0.0);
        Self {
            block,
            chunk,
            column,
            bits,
        }
    }

    /// Returns the lanes in which a flag is set.
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
            self.bits = load_chunk(self.block.column(column), self.chunk, 0.0);
            self.column = column;
        }
    }

    /// Writes the current column. Call it last.
    #[inline(always)]
    pub fn write(&mut self) {
        store_chunk(self.block.column_mut(self.column), self.chunk, &self.bits);
    }
}

/// Out of line: copying a tail of run-time length compiles to memcpy, and every live vector
/// register is spilled around the call; so full chunks take a separate branch.
#[cold]
#[inline(never)]
fn last_chunk(rest: &[f64], past: f64) -> Column {
    let mut part = Column::splat(past);
    part.0[..rest.len()].copy_from_slice(rest);
    part
}

/// See [`last_chunk`].
#[cold]
#[inline(never)]
fn store_last_chunk(rest: &mut [f64], from: &Column) {
    rest.copy_from_slice(&from.0[..rest.len()]);
}
