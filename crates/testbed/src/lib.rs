//! A virtual testbed for pushing experiments.

mod trace;

pub use trace::{Contact, Frame, Trace};
