//! Vectors of the plane as `[f64; 2]`, and rigid motions of it ([`Frame`]).

use crate::Pose;

/// A point or a vector (m), or a direction.
pub(crate) type Vec2 = [f64; 2];

#[inline(always)]
pub(crate) fn add(a: Vec2, b: Vec2) -> Vec2 {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
pub(crate) fn sub(a: Vec2, b: Vec2) -> Vec2 {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
pub(crate) fn scale(s: f64, v: Vec2) -> Vec2 {
    [s * v[0], s * v[1]]
}

#[inline(always)]
pub(crate) fn negate(v: Vec2) -> Vec2 {
    [-v[0], -v[1]]
}

#[inline(always)]
pub(crate) fn dot(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(crate) fn cross(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// `v` turned by +90°.
#[inline(always)]
pub(crate) fn left(v: Vec2) -> Vec2 {
    [-v[1], v[0]]
}

/// `v` turned by −90°: the outward normal of an edge that runs along `v` with its body on the left.
#[inline(always)]
pub(crate) fn right(v: Vec2) -> Vec2 {
    [v[1], -v[0]]
}

#[inline(always)]
pub(crate) fn length(v: Vec2) -> f64 {
    dot(v, v).sqrt()
}

#[inline(always)]
pub(crate) fn unit(v: Vec2) -> Vec2 {
    scale(1.0 / length(v), v)
}

/// A rigid motion p ↦ origin + R p.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub origin: Vec2,
    pub cos: f64,
    pub sin: f64,
}

impl Frame {
    pub fn new(pose: Pose) -> Self {
        let (sin, cos) = libm::sincos(pose.theta);
        Self {
            origin: [pose.x, pose.y],
            cos,
            sin,
        }
    }

    /// R v.
    #[inline(always)]
    pub fn turn(&self, v: Vec2) -> Vec2 {
        [
            self.cos * v[0] - self.sin * v[1],
            self.sin * v[0] + self.cos * v[1],
        ]
    }

    /// Rᵀ v.
    #[inline(always)]
    pub fn turn_back(&self, v: Vec2) -> Vec2 {
        [
            self.cos * v[0] + self.sin * v[1],
            self.cos * v[1] - self.sin * v[0],
        ]
    }

    #[inline(always)]
    pub fn point(&self, p: Vec2) -> Vec2 {
        add(self.origin, self.turn(p))
    }

    #[inline(always)]
    pub fn inverse(&self) -> Frame {
        Frame {
            origin: negate(self.turn_back(self.origin)),
            cos: self.cos,
            sin: -self.sin,
        }
    }
}
