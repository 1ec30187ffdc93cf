//! A contact of two bodies: [`Gap`] of one pair of poses, [`Contact`] of `W` side by side.

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::transform::Transform;
use crate::geometry::vec2::{Vec2, lane_of, splat};

/// A contact of the object with another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Unit normal into the object, world frame.
    pub normal: [f64; 2],
    /// Contact point on the object's boundary minus the object's origin, world frame (m).
    pub arm: [f64; 2],
    /// Gap (m); negative is overlap.
    pub gap: f64,
}

impl Gap {
    /// A contact given in the object's own frame, in the frame that `transform` places it in.
    pub(crate) fn rotated(&self, transform: &Transform) -> Self {
        Self {
            normal: transform.rotate(self.normal),
            arm: transform.rotate(self.arm),
            gap: self.gap,
        }
    }
}

/// A contact between two features, in the lanes that have it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact<const W: usize> {
    /// Number of the pair of features that touch, below [`Contact::ID_COUNT`]; it stays from one
    /// step to the next.
    pub id: u32,
    /// The lanes that have it.
    pub present: Mask<W>,
    /// Unit normal into the object, world frame.
    pub normal: Vec2<Lanes<W>>,
    /// From the object's origin to the contact point on its boundary, world frame (m).
    pub arm: Vec2<Lanes<W>>,
    /// Gap (m).
    pub gap: Lanes<W>,
}

impl<const W: usize> Contact<W> {
    /// Number of ids that one pair of bodies has.
    pub const ID_COUNT: u32 = 1 << 24;

    /// A contact of one lane.
    pub fn in_lane(id: u32, lane: usize, gap: &Gap) -> Self {
        Self {
            id,
            present: Mask::from_fn(|i| i == lane),
            normal: splat(gap.normal),
            arm: splat(gap.arm),
            gap: Lanes::splat(gap.gap),
        }
    }

    /// One lane's contact.
    pub fn lane(&self, lane: usize) -> Gap {
        Gap {
            normal: lane_of(&self.normal, lane),
            arm: lane_of(&self.arm, lane),
            gap: self.gap.0[lane],
        }
    }

    /// Copies the lanes of `mask` from `from`.
    #[inline(always)]
    pub fn assign(&mut self, mask: Mask<W>, from: &Self) {
        for k in 0..2 {
            self.normal[k] = mask.select(from.normal[k], self.normal[k]);
            self.arm[k] = mask.select(from.arm[k], self.arm[k]);
        }
        self.gap = mask.select(from.gap, self.gap);
        self.present = self.present | mask;
    }
}
