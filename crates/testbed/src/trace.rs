//! Record of a simulated experiment: [`Trace`], one [`Frame`] per camera frame.

use stickslip_dynamics::{Body, Friction, Pose, Twist};

/// A simulated experiment: the truth at every camera frame, and the readings of the touch sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The true friction: μ_s is the mean along the object's path, d_tri the radius of the tripod
    /// with the same torque in pure spin.
    pub friction: Friction,
    /// Camera frames, evenly spaced, the first one at time 0.
    pub frames: Vec<Frame>,
    /// Steps without a certified solution, where Γ itself was run; 0 for the rig.
    pub unsolved: usize,
}

/// The truth at one camera frame. World frame, SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time (s).
    pub time: f64,
    /// Pose of the object.
    pub object: Pose,
    /// Twist of the object.
    pub twist: Twist,
    /// Pose of the pusher.
    pub pusher: Pose,
    /// Poses of a hand's other fingers.
    pub other_fingers: Vec<Pose>,
    /// Contacts at this instant.
    pub contacts: Vec<Contact>,
    /// Force of the pusher on the object, mean over the interval that ends here (N).
    pub pusher_force: [f64; 2],
    /// Force of all fingers together, as a sensor between arm and hand measures it (N).
    pub hand_force: [f64; 2],
    /// Normal force of each fixel on the object, mean over the interval that ends here (N).
    pub fixel_forces: Vec<f64>,
    /// Normal force of each finger, the pusher's first, over the same interval (N).
    pub finger_forces: Vec<f64>,
    /// Readings of the touch sensors for that interval: of fixels, then of a hand's fingers.
    pub tactile: Vec<bool>,
}

/// A contact of the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The other body.
    pub body: Body,
    /// Position in the world frame (m).
    pub point: [f64; 2],
    /// Unit normal into the object.
    pub normal: [f64; 2],
    /// Force on the object (N).
    pub force: [f64; 2],
}

impl Trace {
    /// The first frame in whose interval a fixel pressed on the object.
    pub fn first_fixel_contact(&self) -> Option<usize> {
        self.frames
            .iter()
            .position(|frame| frame.fixel_forces.iter().any(|force| *force > 0.0))
    }

    /// The first frame in whose interval a body pressed on the object.
    pub fn first_contact(&self, body: Body) -> Option<usize> {
        self.frames.iter().position(|frame| match body {
            Body::Finger(k) => frame.finger_forces.get(k).is_some_and(|force| *force > 0.0),
            Body::Fixel(j) => frame.fixel_forces.get(j).is_some_and(|force| *force > 0.0),
        })
    }
}
