//! What of a boundary can touch: straight [`Edge`]s, [`Round`] vertices (corners and discs) and
//! [`Ellipse`]s, in the body frame.

use crate::geometry::transform::Frame;
use crate::geometry::vec2::{Vec2, add, cross, dot, length, right, scale, sub, unit};

/// Angle by which a corner's normal cone is widened where it meets an edge (rad): faces that meet,
/// slightly tilted, give two points.
const TILT: f64 = 0.1;

/// Directions at which a full circle of normals is sampled for local maxima of the separation.
const SAMPLES: f64 = 24.0;

/// A straight piece of boundary with the body on its left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub start: Vec2,
    /// Unit direction; the outward normal is this turned by −90°.
    pub along: Vec2,
    /// Length (m).
    pub length: f64,
    /// How far the edge's line runs on inside the body before its start and after its end (m); 0 at
    /// a convex corner.
    pub buried: [f64; 2],
    /// The edges that meet it in a reflex corner at its start and at its end.
    pub reflex: [Option<u32>; 2],
}

impl Edge {
    pub fn between(from: Vec2, to: Vec2) -> Self {
        let d = sub(to, from);
        Self {
            start: from,
            along: unit(d),
            length: length(d),
            buried: [0.0; 2],
            reflex: [None; 2],
        }
    }

    /// Unit outward normal.
    #[inline(always)]
    pub fn normal(&self) -> Vec2 {
        right(self.along)
    }

    /// (distance along the edge from its start, height above its line), both in m.
    #[inline(always)]
    pub fn coordinates(&self, point: Vec2) -> (f64, f64) {
        let d = sub(point, self.start);
        (dot(d, self.along), cross(d, self.along))
    }

    /// The point of its line at distance `s` from its start.
    #[inline(always)]
    pub fn at(&self, s: f64) -> Vec2 {
        add(self.start, scale(s, self.along))
    }

    /// Whether a foot at distance `s` belongs to the edge.
    #[inline(always)]
    pub fn holds(&self, s: f64, slack: f64) -> bool {
        s >= -self.buried[0] - slack && s <= self.length + self.buried[1] + slack
    }
}

/// Outward normals of a round vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// Directions of the edges that end and begin at a corner; zero for a full circle, where every
    /// test then holds.
    pub along: [Vec2; 2],
    /// Unit vector in the middle of the widened cone, and the cosine of half its angle.
    pub middle: Vec2,
    pub cos_tilted: f64,
    /// First sampled direction, cosine and sine of the angle between samples, and how many steps
    /// lead through the cone.
    pub first: Vec2,
    pub step: Vec2,
    pub steps: u32,
}

impl Cone {
    pub fn full() -> Self {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU / SAMPLES);
        Self {
            along: [[0.0; 2]; 2],
            middle: [0.0; 2],
            cos_tilted: -1.0,
            first: [1.0, 0.0],
            step: [cos, sin],
            steps: SAMPLES as u32,
        }
    }

    /// The cone of a convex corner between edges along `before` and `after`.
    pub fn corner(before: Vec2, after: Vec2) -> Self {
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
            cos_tilted: libm::cos(turn / 2.0 + TILT),
            first,
            step: [cos, sin],
            steps: steps as u32,
        }
    }

    /// Whether a direction, of any length, lies in the cone; `slack` has its unit. The borders are
    /// those of the edges beside it.
    #[inline(always)]
    pub fn holds(&self, direction: Vec2, slack: f64) -> bool {
        dot(self.along[0], direction) >= -slack && dot(self.along[1], direction) <= slack
    }

    /// The largest n·d over the unit vectors n of the cone.
    pub fn support(&self, d: Vec2) -> f64 {
        if self.holds(d, 0.0) {
            return length(d);
        }
        let [first, last] = self.along.map(|along| dot(right(along), d));
        if first > last { first } else { last }
    }

    pub fn is_full(&self) -> bool {
        self.along == [[0.0; 2]; 2]
    }
}

/// A convex corner (radius 0, the cone between its edges' normals) or a disc (all normals).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    pub centre: Vec2,
    /// Radius (m).
    pub radius: f64,
    pub cone: Cone,
    /// Whether a sibling part hides some of it.
    pub covered: bool,
}

/// An ellipse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    pub centre: Vec2,
    /// Unit vector of the first axis.
    pub axis: Vec2,
    /// Half lengths of the axes (m).
    pub semi_axes: [f64; 2],
    /// Whether a sibling part hides some of it.
    pub covered: bool,
}

impl Ellipse {
    /// Half the width in direction `n` (unit): h(n) = max of n·p over the ellipse about its centre
    /// (m).
    #[inline(always)]
    pub fn support(&self, n: Vec2) -> f64 {
        let [a, b] = self.semi_axes;
        let (c, s) = (a * dot(self.axis, n), b * cross(self.axis, n));
        (c * c + s * s).sqrt()
    }

    /// The boundary point with outward normal `n`.
    pub fn point(&self, n: Vec2) -> Vec2 {
        let [a, b] = self.semi_axes;
        let h = self.support(n);
        let (x, y) = (
            a * (a * dot(self.axis, n) / h),
            b * (b * cross(self.axis, n) / h),
        );
        add(
            self.centre,
            [
                x * self.axis[0] - y * self.axis[1],
                x * self.axis[1] + y * self.axis[0],
            ],
        )
    }

    pub fn seen_from(&self, frame: &Frame) -> Self {
        Self {
            centre: frame.point(self.centre),
            axis: frame.turn(self.axis),
            ..*self
        }
    }

    /// Smallest distance of its boundary from its centre (m).
    pub fn inner_radius(&self) -> f64 {
        let [a, b] = self.semi_axes;
        if a < b { a } else { b }
    }

    /// Largest distance of its points from its centre (m).
    #[inline(always)]
    pub fn radius(&self) -> f64 {
        let [a, b] = self.semi_axes;
        if a > b { a } else { b }
    }
}
