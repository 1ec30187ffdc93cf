//! Prior knowledge of an experiment: object, support, pusher, fixels and nominal friction
//! ([`Scene`]).

use crate::friction::Friction;
use crate::geometry::shape::Shape;
use crate::input::Body;
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

/// The driven body, a position source with an optional stall force: one finger (thumb), or the
/// fingers of a hand that share a drive.
#[derive(Clone, Debug)]
pub struct Pusher {
    /// Outline of each finger in its own frame: 1 to [`MOST_FINGERS`](crate::MOST_FINGERS).
    pub fingers: Vec<Shape>,
    /// Force at which the drive yields (N), summed over the fingers, each along its own direction;
    /// `None` is a rigid position source.
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
    /// The fixels.
    pub fixels: Vec<Fixel>,
    /// Nominal friction parameters.
    pub nominal: Friction,
}

impl Scene {
    /// Number of bodies besides the object and the pusher's first finger.
    pub fn others(&self) -> usize {
        self.fixels.len() + self.pusher.fingers.len() - 1
    }

    /// The one of them with index `j`: the fixels, then the other fingers.
    pub fn other(&self, j: usize) -> Body {
        match j.checked_sub(self.fixels.len()) {
            None => Body::Fixel(j),
            Some(finger) => Body::Finger(1 + finger),
        }
    }

    /// The body of contact `k` of an estimate: the pusher's first finger, then the others.
    pub fn contact(&self, k: usize) -> Body {
        k.checked_sub(1).map_or(Body::Finger(0), |j| self.other(j))
    }

    /// Number of the tactile sensor on a body, where it has one.
    pub fn sensor(&self, body: Body) -> usize {
        match body {
            Body::Fixel(j) => j,
            Body::Finger(i) => self.fixels.len() + i,
        }
    }

    /// Number of bodies that may have a tactile sensor: the fixels, then the fingers of a hand of
    /// several.
    pub fn sensors(&self) -> usize {
        match self.pusher.fingers.len() {
            1 => self.fixels.len(),
            fingers => self.fixels.len() + fingers,
        }
    }

    /// The body of sensor `k`.
    pub fn sensed(&self, k: usize) -> Body {
        match k.checked_sub(self.fixels.len()) {
            None => Body::Fixel(k),
            Some(finger) => Body::Finger(finger),
        }
    }
}
