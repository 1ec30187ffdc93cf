//! Particle filtering over any [`Model`], and the Kalman filter and smoother.
//!
//! A [`ParticleFilter`] owns a [`ParticleSet`] (columns of f64 in blocks of [`BLOCK`] particles),
//! its [`LogWeights`] and counter-based random [`Streams`]; what a particle means is the model's
//! business.
//!
//! Invariants:
//! - every result is a function of (model, inputs, seed, number of particles): random numbers are a
//!   pure function of (seed, purpose, step, particle, draw), and every sum runs in one fixed order,
//!   whatever the threads;
//! - a weight is never NaN; a set that no longer explains its observation is a counted outcome,
//!   [`Weighing::Collapsed`];
//! - after the first steps, a step on one thread allocates nothing.
//!
//! Threads are the caller's choice: run inside `rayon::ThreadPool::install` to bound them, and
//! inside [`keep_threads_awake`] where one filter has them to itself.

mod awake;
mod box_muller;
mod constant_velocity;
mod exponential;
mod filter;
mod innovations;
mod kalman;
mod model;
mod moments;
mod parallel;
mod particles;
mod process_noise;
mod resample;
mod series;
mod streams;
mod update;
mod velocity_bank;
mod weights;

pub use awake::keep_threads_awake;
pub use constant_velocity::{AxisEstimate, ConstantVelocity, Filtered};
pub use filter::{ParticleFilter, Settings, SettingsError, StepReport, Weighing};
pub use kalman::{Gaussian, Update};
pub use model::{Model, WeightedSums};
pub use particles::{BLOCK, Block, BlockMut, ParticleSet};
pub use process_noise::{Optimum, ProcessNoiseFit};
pub use resample::Resampling;
pub use series::SeriesError;
pub use streams::{Draw, Purpose, Streams};
pub use velocity_bank::{BankState, VelocityBank};
pub use weights::{LogWeights, WeightError};
