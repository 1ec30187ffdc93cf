//! Input of one time step: [`StepInput`].

use stickslip_lanes::Lanes;

use crate::se2::{Pose, Twist};
use crate::support::Support;

/// The pusher during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PusherMotion<T = f64> {
    /// Pose at the start of the step.
    pub pose: Pose<T>,
    /// Commanded twist during the step.
    pub twist: Twist<T>,
    /// Unit vector of its commanded translation (the last one where it stands). A pusher with a
    /// force limit may yield in this direction.
    pub direction: [T; 2],
}

impl PusherMotion {
    /// Copies the motion into every lane.
    #[inline(always)]
    pub(crate) fn splat<const W: usize>(&self) -> PusherMotion<Lanes<W>> {
        let [dx, dy] = self.direction;
        PusherMotion {
            pose: self.pose.map(Lanes::splat),
            twist: self.twist.map(Lanes::splat),
            direction: [Lanes::splat(dx), Lanes::splat(dy)],
        }
    }
}

/// Offsets of pusher, fixels and feet from the poses that the input and the scene give, particle by
/// particle.
#[derive(Clone, Copy, Debug)]
pub struct Offsets<'a, const W: usize> {
    /// Offset of the pusher (m), chunk by chunk.
    pub pusher: &'a [[Lanes<W>; 2]],
    /// Angles by which the pusher is turned from its pose (rad), chunk by chunk; empty where it is
    /// not turned.
    pub pusher_turn: &'a [Lanes<W>],
    /// Offsets of the fixels (m): those of the first chunk, then those of the second, ...
    pub fixels: &'a [[Lanes<W>; 2]],
    /// Affine images of the scene's feet, chunk by chunk. Empty where they stand as in the scene.
    pub supports: &'a [Support<Lanes<W>>],
}

/// Input of one step.
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

impl Body {
    /// Numbered from 1; 0 is no body.
    pub(crate) fn number(self) -> usize {
        match self {
            Body::Pusher => 1,
            Body::Fixel(j) => 2 + j,
        }
    }
}
