//! Tracks a pushed object through contact and visual occlusion and learns the friction that governs it.

mod estimate;
mod log;
mod setup;

pub use estimate::{Estimate, EstimateRow, Spread};
pub use log::Log;
pub use setup::{Camera, FilterSettings, Limits, Setup, Tactile};
pub use stickslip_dynamics as dynamics;
