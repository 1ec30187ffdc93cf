//! A virtual testbed for pushing experiments.

pub mod camera;
