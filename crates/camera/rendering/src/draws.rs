//! Random numbers that a frame draws: [`FIRST_DRAW`].

/// Random numbers of a frame are counted from here, past those of other sensors with the same seed.
pub(crate) const FIRST_DRAW: u32 = 1 << 30;
