//! Tracks a pushed object through contact and visual occlusion and adapts the friction that governs
//! it.
//!
//! [`Tracker`] takes one row at a time; [`run`] takes a whole [`Log`].

mod angle;
mod baseline;
mod belief_mode;
mod contact_slip;
mod counted;
mod covariance;
pub mod diagnosis;
mod error;
mod estimate;
mod filter_model;
mod gap;
mod log;
mod occlusion;
mod options;
mod outcomes;
mod particle;
mod particle_budget;
mod pose_clock;
mod prepared_log;
mod prior_sample;
mod pusher;
mod quantile;
mod range;
mod row;
mod run;
mod setup;
mod setup_check;
mod tracker;
mod trajectory;
mod tuning;
mod uncertainty;

pub use angle::wrapped;
pub use baseline::predictor::{NominalPrediction, NominalPredictor, Surface};
pub use belief_mode::BeliefMode;
pub use contact_slip::ContactSlip;
pub use counted::counted;
pub use covariance::PoseCovariance;
pub use error::RunError;
pub use estimate::{CrossCovariance, Estimate, EstimateRow, Spread};
pub use filter_model::FilterModel;
pub use log::Log;
pub use occlusion::Occlusion;
pub use options::{Method, RunOptions, TactileUse};
pub use outcomes::{ContactSet, Outcomes, Plan, PlanError};
pub use particle::set::observer::{Observer, SolvedStep};
pub use particle::set::view::ParticleView;
pub use particle_budget::ParticleBudget;
pub use prior_sample::{PriorSample, SampledState};
pub use pusher::schedule::Schedule;
pub use pusher::track::{PusherTrack, Tracking};
pub use pusher::tracked_pose::TrackedPose;
pub use quantile::quantile;
pub use range::{Rule, SetupError, Unit};
pub use row::{Row, RowError, counted_bodies};
pub use run::{Run, run, run_observed};
pub use setup::{Camera, FilterSettings, ForceSensor, Limits, Setup, Tactile};
pub use stickslip_dynamics as dynamics;
pub use stickslip_filter::{keep_threads_awake, useful_threads};
pub use tracker::{StepSize, Tracker, TrackerOptions};
pub use trajectory::Trajectory;
pub use tuning::{ASSUMED_STALL, SHORTEST_STEP};
pub use uncertainty::Uncertainty;
