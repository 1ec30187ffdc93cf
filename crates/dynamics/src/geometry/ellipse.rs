//! An ellipse in the body frame: [`Ellipse`].

use std::ops::Div;

use stickslip_lanes::Lanes;

use crate::geometry::edge::{Cover, Edge};
use crate::geometry::transform::Transform;
use crate::geometry::vec2::{Number, Vec2, add, cross, dot, left, sub};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    pub centre: Vec2,
    /// Unit vector of the first axis.
    pub axis: Vec2,
    /// Half lengths of the axes (m).
    pub semi_axes: [f64; 2],
    /// True if a sibling part hides some of it.
    pub covered: bool,
}

impl Ellipse {
    pub fn new(centre: Vec2, axis: Vec2, semi_axes: [f64; 2]) -> Self {
        Self {
            centre,
            axis,
            semi_axes,
            covered: false,
        }
    }

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

    /// The ellipse in the frame that `transform` places its body in.
    pub fn transformed(&self, transform: &Transform) -> Self {
        Self {
            centre: transform.transform_point(self.centre),
            axis: transform.rotate(self.axis),
            ..*self
        }
    }

    /// Smallest distance of its boundary from its centre (m).
    #[inline(always)]
    pub fn inner_radius(&self) -> f64 {
        let [a, b] = self.semi_axes;
        if a < b { a } else { b }
    }

    /// Largest distance of its points from its centre (m).
    #[inline(always)]
    pub fn outer_radius(&self) -> f64 {
        let [a, b] = self.semi_axes;
        if a > b { a } else { b }
    }

    /// A vector, scaled by the map that makes the ellipse a unit circle.
    #[inline(always)]
    pub fn normalise<T: Number<f64> + Div<f64, Output = T>>(&self, d: Vec2<T>) -> Vec2<T> {
        let [a, b] = self.semi_axes;
        [dot(d, self.axis) / a, dot(d, left(self.axis)) / b]
    }

    /// Depth of points inside (m; negative outside): exact for a disc inside, in sign for an
    /// ellipse.
    #[inline(always)]
    pub fn depth<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Lanes<W> {
        let scaled = self.normalise(sub(points, self.centre));
        (-dot(scaled, scaled).sqrt() + 1.0) * self.inner_radius()
    }

    /// The stretch of `edge` between the roots of |S (start + s along − centre)|² = 1, S as in
    /// [`normalise`](Self::normalise).
    pub fn cover(&self, edge: &Edge) -> Option<Cover> {
        let d = self.normalise(sub(edge.start, self.centre));
        let t = self.normalise(edge.along);
        let (half, tt) = (dot(d, t), dot(t, t));
        let discriminant = half * half - tt * (dot(d, d) - 1.0);
        let root = Some(discriminant).filter(|x| *x > 0.0)?.sqrt();
        let low = ((-half - root) / tt).max(0.0);
        let high = ((-half + root) / tt).min(edge.length);
        Some(Cover {
            tolerant: [low, high],
            exact: [low, high],
            flush: false,
        })
    }
}
