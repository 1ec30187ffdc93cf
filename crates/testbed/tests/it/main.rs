//! The virtual testbed against closed forms and recorded trajectories.

mod common;
mod reference_trajectory;
mod traces;
