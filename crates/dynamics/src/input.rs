//! What drives one time step: [`StepInput`].

use crate::se2::{Pose, Twist};

/// The pusher during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PusherMotion {
    /// Pose at the start of the step.
    pub pose: Pose,
    /// Commanded twist during the step.
    pub twist: Twist,
    /// Unit vector of its commanded translation (the last one where it stands): the direction in
    /// which it may give way.
    pub direction: [f64; 2],
}

/// What drives one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput {
    /// Step (s).
    pub h: f64,
    /// The pusher; `None` while it is off the plane.
    pub pusher: Option<PusherMotion>,
}

/// A body that the object may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The pusher.
    Pusher,
    /// The fixel of this index.
    Fixel(usize),
}
