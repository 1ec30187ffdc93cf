//! What the particle filter is compared with: the nominal simulation and the Kalman filter.

pub(crate) mod kalman;
pub(crate) mod nominal;
