//! Sensors: readings, and how likely they are given a particle.

pub(crate) mod camera_gate;
pub(crate) mod camera_likelihood;
pub(crate) mod camera_noise;
pub(crate) mod force_likelihood;
pub(crate) mod observation;
pub(crate) mod pusher_likelihood;
pub(crate) mod tactile_likelihood;
pub(crate) mod touch_channel;
pub(crate) mod touch_likelihood;
