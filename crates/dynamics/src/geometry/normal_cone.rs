//! Normals of a corner or a disc: [`NormalCone`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::vec2::{Vec2, cross, dot, right};

/// Angle by which a corner's normal cone is widened where it meets an edge (rad): faces that meet,
/// slightly tilted, give two points.
const TILT: f64 = 0.1;

/// Outward normals of a rounded vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalCone {
    /// Directions of the edges that end and begin at a corner; zero for a full circle, where every
    /// test then holds.
    pub along: [Vec2; 2],
    /// Unit vector in the middle of the widened cone, and the cosine of half its angle.
    pub middle: Vec2,
    pub cos_widened: f64,
}

impl NormalCone {
    pub fn full() -> Self {
        Self {
            along: [[0.0; 2]; 2],
            middle: [0.0; 2],
            cos_widened: -1.0,
        }
    }

    /// The cone of a convex corner between edges along `before` and `after`.
    pub fn of_corner(before: Vec2, after: Vec2) -> Self {
        let turn = libm::atan2(cross(before, after), dot(before, after));
        let (half_sin, half_cos) = libm::sincos(turn / 2.0);
        let first = right(before);
        let middle = [
            half_cos * first[0] - half_sin * first[1],
            half_sin * first[0] + half_cos * first[1],
        ];
        Self {
            along: [before, after],
            middle,
            cos_widened: libm::cos(turn / 2.0 + TILT),
        }
    }

    pub fn is_full(&self) -> bool {
        self.along == [[0.0; 2]; 2]
    }

    /// Lanes in which a direction, of any length, lies in the cone; `slack` has its unit. The
    /// borders are those of the edges next to it.
    #[inline(always)]
    pub fn contains_each<const W: usize>(&self, direction: Vec2<Lanes<W>>, slack: f64) -> Mask<W> {
        let [before, after] = self.along;
        !dot(direction, before).lt(Lanes::splat(-slack))
            & !dot(direction, after).gt(Lanes::splat(slack))
    }

    /// Lanes in which a unit vector lies in the widened cone.
    #[inline(always)]
    pub fn nearly_contains_each<const W: usize>(&self, normal: Vec2<Lanes<W>>) -> Mask<W> {
        !dot(normal, self.middle).lt(Lanes::splat(self.cos_widened))
    }
}
