//! A virtual testbed for pushing experiments: [`Rig`], a physics that is finer than the model's and
//! another one, [`Model`], the model itself, and the [`Tracker`] that measures what either of them
//! did; and an overhead [`camera`] that takes frames of it.
//!
//! All of it is a function of scene, start, settings and seed; the same arguments give the same
//! bits.

pub mod camera;
mod guess;
mod model;
mod rig;
mod touch;
mod trace;
mod tracker;
mod trial;

pub use guess::true_friction;
pub use model::Model;
pub use rig::{Bristles, ContactLaw, DriveSettings, Footing, Rig, Spindle, SupportPoint, Table};
pub use touch::TouchSensors;
pub use trace::{Contact, Frame, Trace};
pub use tracker::{Sighting, Tracker};
pub use trial::{Trial, TrialError};
