//! Reported values: sums over the particles, the published pose, peaks of the belief.

pub(crate) mod end;
pub(crate) mod geometric_median;
pub(crate) mod group;
pub(crate) mod mode_finder;
pub(crate) mod summary;
pub(crate) mod sums;
