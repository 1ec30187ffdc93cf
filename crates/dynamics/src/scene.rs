//! Prior knowledge of an experiment: object, support, pusher, fixels and nominal friction
//! ([`Scene`]).

use crate::friction::Friction;
use crate::geometry::shape::Shape;
use crate::se2::Pose;

/// The pushed object; the origin of its frame is its centre of mass.
#[derive(Clone, Debug)]
pub struct Object {
    /// Mass (kg).
    pub mass: f64,
    /// Moment of inertia about the centre of mass (kg m²).
    pub inertia: f64,
    /// Outline in the object frame.
    pub shape: Shape,
}

impl Object {
    /// Radius of gyration sqrt(J / m) (m).
    pub fn gyration_radius(&self) -> f64 {
        (self.inertia / self.mass).sqrt()
    }
}

/// Positions of the feet on which the object stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feet {
    /// Three feet 120° apart at radius d_tri, a third of the weight each; the first one in
    /// direction `angle` (rad) of the object frame.
    Tripod {
        /// Direction of the first foot in the object frame (rad).
        angle: f64,
    },
    /// Three known feet.
    Known {
        /// Positions in the object frame (m).
        positions: [[f64; 2]; 3],
        /// Share of the weight on each foot; they sum to 1.
        loads: [f64; 3],
    },
}

/// The pusher (thumb): a position source with an optional stall force.
#[derive(Clone, Debug)]
pub struct Pusher {
    /// Outline in the pusher frame.
    pub shape: Shape,
    /// Force at which it yields (N); `None` is a rigid position source.
    pub stall_force: Option<f64>,
}

/// A fixed finger.
#[derive(Clone, Debug)]
pub struct Fixel {
    /// Pose in the world.
    pub pose: Pose,
    /// Outline in the fixel frame.
    pub shape: Shape,
}

/// Everything that the contact dynamics needs to know and that does not change during an
/// experiment.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Gravity (m/s²), presses the object on the support.
    pub gravity: f64,
    /// The object.
    pub object: Object,
    /// Its feet.
    pub feet: Feet,
    /// The pusher.
    pub pusher: Pusher,
    /// The fixels; sensor k is the k-th one.
    pub fixels: Vec<Fixel>,
    /// Nominal friction parameters.
    pub nominal: Friction,
}
