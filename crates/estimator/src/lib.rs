//! Tracks a pushed object through contact and visual occlusion and learns the friction that governs
//! it.

mod angle;
mod chunk;
mod cloud;
mod columns;
mod contact_model;
pub mod diagnosis;
mod error;
mod estimate;
mod kalman_baseline;
mod log;
mod nominal;
mod occlusion;
mod particle_run;
mod propagation;
mod quantile;
mod run;
mod schedule;
mod setup;
mod summary;
mod sums;
mod track;
mod trajectory;
mod watch;

pub use angle::wrapped;
pub use cloud::Cloud;
pub use error::RunError;
pub use estimate::{Estimate, EstimateRow, Spread};
pub use log::Log;
pub use occlusion::Occlusion;
pub use quantile::quantile;
pub use run::{Method, Run, RunOptions, TactileUse, run, run_watched};
pub use schedule::Schedule;
pub use setup::{Camera, FilterSettings, Limits, Setup, Tactile};
pub use stickslip_dynamics as dynamics;
pub use stickslip_filter::keep_threads_awake;
pub use track::{PusherTrack, TrackedPose, Tracking};
pub use trajectory::Trajectory;
pub use watch::{SolvedStep, StepWatch};
