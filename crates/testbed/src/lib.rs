//! A virtual testbed for pushing experiments: [`Rig`], a compliant physics finer than the model's,
//! [`Model`], the model itself, and a [`TrackingCamera`] that measures the motion of either.
//!
//! All of it is a function of scene, start, settings and seed; the same arguments give the same
//! bits.

mod model;
mod rig;
mod touch;
mod trace;
mod tracking_camera;
mod trial;
mod true_friction;

pub use model::Model;
pub use rig::{
    Bristles, ContactLaw, DriveSettings, PressureDistribution, Rig, Spindle, SupportPoint,
    TableFriction,
};
pub use touch::TouchSensors;
pub use trace::{Contact, Frame, Trace};
pub use tracking_camera::{CameraMeasurement, TrackingCamera};
pub use trial::{Trial, TrialError};
pub use true_friction::true_friction;
