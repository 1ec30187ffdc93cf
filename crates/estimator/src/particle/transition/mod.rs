//! How a particle moves over one step.

pub(crate) mod closure;
pub(crate) mod contact_flags;
mod held;
pub(crate) mod involved;
mod lags;
pub(crate) mod noise_clock;
pub(crate) mod propagation;
pub(crate) mod step_plan;
pub(crate) mod unseen_pusher;
pub(crate) mod untouched;
