//! Tracks a pushed object through contact and visual occlusion and learns the friction that governs
//! it.
//!
//! [`Tracker`] takes one row at a time; [`run`] takes a whole [`Log`].

mod angle;
mod baseline;
pub mod diagnosis;
mod error;
mod estimate;
mod log;
mod occlusion;
mod options;
mod particle;
mod prepared_log;
mod pusher;
mod row;
mod run;
mod score;
mod setup;
mod statistics;
mod tracker;
mod trajectory;

pub use error::RunError;
pub use estimate::{Estimate, EstimateRow, Spread};
pub use log::Log;
pub use occlusion::Occlusion;
pub use options::{Method, RunOptions, TactileUse};
pub use particle::observer::{Observer, SolvedStep};
pub use particle::view::ParticleView;
pub use pusher::schedule::Schedule;
pub use pusher::track::{PusherTrack, TrackedPose, Tracking};
pub use row::{Row, RowError};
pub use run::{Run, run, run_observed};
pub use score::{Reference, Scores, score};
pub use setup::{Camera, FilterSettings, Limits, Setup, Tactile};
pub use statistics::{Band, Direction, PairedDifference, quantile};
pub use stickslip_dynamics as dynamics;
pub use stickslip_filter::keep_threads_awake;
pub use tracker::{Tracker, TrackerOptions};
pub use trajectory::Trajectory;
