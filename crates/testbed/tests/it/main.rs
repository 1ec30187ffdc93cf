//! The virtual testbed against closed forms and recorded trajectories.

mod common;
mod hand;
mod reference_trajectory;
mod traces;
