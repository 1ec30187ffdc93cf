//! Normals of a corner or a disc: [`NormalCone`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::vec2::{Vec2, cross, dot, length, right};

/// Angle by which a corner's normal cone is widened where it meets an edge (rad): faces that meet,
/// slightly tilted, give two points.
const TILT: f64 = 0.1;

/// Directions at which a full circle of normals is sampled for local maxima of the separation.
const SAMPLES: f64 = 24.0;

/// Outward normals of a rounded vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalCone {
    /// Directions of the edges that end and begin at a corner; zero for a full circle, where every
    /// test then holds.
    pub along: [Vec2; 2],
    /// Unit vector in the middle of the widened cone, and the cosine of half its angle.
    pub middle: Vec2,
    pub cos_widened: f64,
    /// First sampled direction, cosine and sine of the angle between samples, and how many steps
    /// lead through the cone.
    pub first: Vec2,
    pub step: Vec2,
    pub steps: u32,
}

impl NormalCone {
    pub fn full() -> Self {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU / SAMPLES);
        Self {
            along: [[0.0; 2]; 2],
            middle: [0.0; 2],
            cos_widened: -1.0,
            first: [1.0, 0.0],
            step: [cos, sin],
            steps: SAMPLES as u32,
        }
    }

    /// The cone of a convex corner between edges along `before` and `after`.
    pub fn of_corner(before: Vec2, after: Vec2) -> Self {
        let turn = libm::atan2(cross(before, after), dot(before, after));
        let steps = (SAMPLES * turn.abs() / std::f64::consts::TAU).ceil() + 1.0;
        let (sin, cos) = libm::sincos(turn / steps);
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
            first,
            step: [cos, sin],
            steps: steps as u32,
        }
    }

    pub fn is_full(&self) -> bool {
        self.along == [[0.0; 2]; 2]
    }

    /// Returns true if a direction, of any length, lies in the cone; `slack` has its unit. The
    /// borders are those of the edges next to it.
    pub fn contains(&self, direction: Vec2, slack: f64) -> bool {
        dot(self.along[0], direction) >= -slack && dot(self.along[1], direction) <= slack
    }

    /// [`contains`](Self::contains), lane by lane.
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

    /// The largest n·d over the unit vectors n of the cone.
    pub fn support(&self, d: Vec2) -> f64 {
        if self.contains(d, 0.0) {
            return length(d);
        }
        let [first, last] = self.along.map(|along| dot(right(along), d));
        if first > last { first } else { last }
    }
}
