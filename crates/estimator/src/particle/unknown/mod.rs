//! Unknowns of a particle: their table, their units, friction, and the columns that a camera pose
//! moves.

pub(crate) mod friction;
pub(crate) mod moved;
pub(crate) mod table;
pub(crate) mod units;
