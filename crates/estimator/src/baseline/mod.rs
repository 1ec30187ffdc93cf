//! Baselines of the particle filter: the nominal simulation, the Kalman filter, two rules for it
//! while the camera is off, and an extended Kalman filter through Γ.

mod belief;
pub(crate) mod extended_kalman;
mod in_the_dark;
pub(crate) mod kalman;
mod linearised_step;
pub(crate) mod nominal;
mod pose_update;
pub(crate) mod predictor;

pub(crate) use in_the_dark::{stopping, with_pusher};
