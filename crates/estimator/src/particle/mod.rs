//! The particle filter over contact dynamics: the model, its columns, and what they amount to.

mod camera_clock;
mod camera_likelihood;
pub(crate) mod camera_noise;
mod chunk;
mod columns;
pub(crate) mod contact_filter;
mod contact_flags;
mod contact_mode;
mod group;
mod history;
mod mode_finder;
mod model;
mod moved;
pub(crate) mod noise_clock;
pub(crate) mod observation;
pub(crate) mod observer;
pub(crate) mod propagation;
mod replay;
mod resting_pose;
mod rig;
mod steadiness;
mod step_plan;
mod summary;
mod sums;
mod tactile_likelihood;
pub(crate) mod touch_channel;
pub(crate) mod view;
