//! Particle filtering over any [`Model`], and the Kalman filter and smoother.
//!
//! A [`ParticleFilter`] owns a [`ParticleSet`] (columns of f64 in blocks of [`BLOCK`] particles),
//! its [`LogWeights`] and counter-based random [`Streams`]; the meaning of a particle is left to
//! the model.
//!
//! Invariants:
//! - every result is a function of (model, inputs, seed, number of particles): random numbers are a
//!   pure function of (seed, purpose, step, particle, draw), and every sum runs in one fixed order,
//!   whatever the threads;
//! - a weight is never NaN; a set that no longer explains its observation is a counted outcome,
//!   [`WeightUpdate::Collapsed`];
//! - after the first steps, a step on one thread allocates nothing.
//!
//! Threads are the caller's choice: run inside `rayon::ThreadPool::install` to bound them (more
//! than [`useful_threads`] bring nothing), and inside [`keep_threads_awake`] where one filter has
//! them to itself. They help where the system runs them; a filter does not wait for those that it
//! does not.

mod bridge;
mod ensemble;
mod filter;
mod kalman;
mod lineage;
mod model;
mod moments;
mod particles;
mod report;
mod resample;
mod settings;
mod streams;
mod threads;
mod weights;

pub use ensemble::EnsembleShape;
pub use filter::ParticleFilter;
pub use kalman::constant_velocity::{AxisEstimate, ConstantVelocity, Filtered};
pub use kalman::gaussian::{Gaussian, MeasurementUpdate};
pub use kalman::imm::{ImmState, InteractingMultipleModel};
pub use kalman::noise_fit::{Optimum, ProcessNoiseFit};
pub use kalman::series::SeriesError;
pub use lineage::Lineage;
pub use model::{Model, WeightedSums};
pub use particles::{BLOCK, Block, BlockMut, ParticleSet, useful_threads};
pub use report::{StepReport, WeightUpdate};
pub use resample::Resampling;
pub use settings::{Settings, SettingsError};
pub use streams::{Draw, Purpose, Streams};
pub use threads::awake::keep_threads_awake;
pub use weights::{LogWeights, WeightError};
