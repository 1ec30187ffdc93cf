//! What the particle filter is compared with: the nominal simulation, the Kalman filter, and what a
//! line of code makes of it in the dark.

mod in_the_dark;
pub(crate) mod kalman;
pub(crate) mod nominal;
pub(crate) mod predictor;

pub(crate) use in_the_dark::{stopping, with_pusher};
