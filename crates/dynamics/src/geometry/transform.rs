//! Rigid motions of the plane: [`Transform`].

use stickslip_lanes::{Lanes, sin_cos};

use crate::geometry::vec2::{Number, Vec2, add, lane_of, negate, splat, sub};
use crate::se2::Pose;

/// A rigid motion p ↦ origin + R p, which takes a body's own coordinates to those of the frame that
/// the body is placed in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform<T = f64> {
    pub origin: Vec2<T>,
    pub cos: T,
    pub sin: T,
}

impl From<Pose> for Transform {
    fn from(Pose { x, y, theta }: Pose) -> Self {
        let (sin, cos) = libm::sincos(theta);
        Self {
            origin: [x, y],
            cos,
            sin,
        }
    }
}

impl<const W: usize> From<Pose<Lanes<W>>> for Transform<Lanes<W>> {
    #[inline(always)]
    fn from(Pose { x, y, theta }: Pose<Lanes<W>>) -> Self {
        let (sin, cos) = sin_cos(theta);
        Self {
            origin: [x, y],
            cos,
            sin,
        }
    }
}

impl<T: Number> Transform<T> {
    /// R v.
    #[inline(always)]
    pub fn rotate<S: Copy>(&self, v: Vec2<S>) -> Vec2<T>
    where
        T: Number<S>,
    {
        [
            self.cos * v[0] - self.sin * v[1],
            self.sin * v[0] + self.cos * v[1],
        ]
    }

    /// Rᵀ v.
    #[inline(always)]
    pub fn inv_rotate<S: Copy>(&self, v: Vec2<S>) -> Vec2<T>
    where
        T: Number<S>,
    {
        [
            self.cos * v[0] + self.sin * v[1],
            self.cos * v[1] - self.sin * v[0],
        ]
    }

    /// origin + R p.
    #[inline(always)]
    pub fn transform_point<S: Copy>(&self, p: Vec2<S>) -> Vec2<T>
    where
        T: Number<S>,
    {
        add(self.origin, self.rotate(p))
    }

    /// This placement in the coordinates of the body that is placed at `base`.
    #[inline(always)]
    pub fn relative_to(&self, base: &Self) -> Self {
        Self {
            origin: base.inv_rotate(sub(self.origin, base.origin)),
            cos: base.cos * self.cos + base.sin * self.sin,
            sin: base.cos * self.sin - base.sin * self.cos,
        }
    }

    #[inline(always)]
    pub fn inverse(&self) -> Self {
        Self {
            origin: negate(self.inv_rotate(self.origin)),
            cos: self.cos,
            sin: -self.sin,
        }
    }
}

impl Transform {
    /// Copies the transform into every lane.
    #[inline(always)]
    pub fn splat<const W: usize>(&self) -> Transform<Lanes<W>> {
        Transform {
            origin: splat(self.origin),
            cos: Lanes::splat(self.cos),
            sin: Lanes::splat(self.sin),
        }
    }
}

impl<const W: usize> Transform<Lanes<W>> {
    /// One lane's transform.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Transform {
        Transform {
            origin: lane_of(&self.origin, lane),
            cos: self.cos.0[lane],
            sin: self.sin.0[lane],
        }
    }
}
