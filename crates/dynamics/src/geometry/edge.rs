//! Straight boundary: [`Edge`], and which of its points something covers: [`Cover`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::vec2::{Number, Vec2, add, cross, dot, length, right, scale, sub, unit};

/// A straight piece of boundary with the body on its left, in the body frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub start: Vec2,
    /// Unit direction; the outward normal is this turned by −90°.
    pub along: Vec2,
    /// Length (m).
    pub length: f64,
    /// Lengths by which the edge's line runs on inside the body before its start and after its end
    /// (m); 0 at a convex corner.
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
    pub fn coordinates<T: Number<f64>>(&self, point: Vec2<T>) -> (T, T) {
        let d = sub(point, self.start);
        (dot(d, self.along), cross(d, self.along))
    }

    /// The point of its line at distance `s` from its start.
    #[inline(always)]
    pub fn at<T: Number<f64>>(&self, s: T) -> Vec2<T> {
        add(scale(s, self.along), self.start)
    }

    /// Lanes in which a projection at distance `s` from its start belongs to the edge.
    #[inline(always)]
    pub fn spans_each<const W: usize>(&self, s: Lanes<W>, slack: f64) -> Mask<W> {
        let [before, after] = self.buried;
        !s.lt(Lanes::splat(-slack - before)) & !s.gt(Lanes::splat(slack + (self.length + after)))
    }
}

/// The stretch of an edge that a convex part covers, as distances from the edge's start (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cover {
    /// Covered within the tolerance.
    pub tolerant: [f64; 2],
    /// Covered to the very surface.
    pub exact: [f64; 2],
    /// True if the edge lies on the part's surface with its body on the same side.
    pub flush: bool,
}

impl Cover {
    /// Pieces of a stretch that the cover leaves. The tolerant ends decide whether there is a
    /// piece, the exact ends where it is cut.
    pub fn subtract_from(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
        let [from, to] = self.tolerant;
        let (mut before, mut after) = ([low, low], [high, high]);
        if to <= low || from >= high {
            before = [low, high];
        } else {
            if from > low {
                before = [low, self.exact[0].min(high)];
            }
            if to < high {
                after = [self.exact[1].max(low), high];
            }
        }
        [before, after].into_iter().filter(|[a, b]| b > a)
    }
}
