//! Kalman filters and smoothers of one axis whose position is measured.

pub(crate) mod constant_velocity;
pub(crate) mod gaussian;
pub(crate) mod imm;
pub(crate) mod noise_fit;
pub(crate) mod series;
