//! Rigid motions of the plane, `W` side by side: [`Frames`].

use stickslip_lanes::{Lanes, sin_cos};

use crate::geometry::vec2::{Vec2, add, negate};
use crate::se2::Pose;

/// A vector per lane.
pub(crate) type Vec2s<const W: usize> = [Lanes<W>; 2];

#[inline(always)]
pub(crate) fn dot<const W: usize>(a: &Vec2s<W>, b: &Vec2s<W>) -> Lanes<W> {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(crate) fn cross<const W: usize>(a: &Vec2s<W>, b: &Vec2s<W>) -> Lanes<W> {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
pub(crate) fn sub<const W: usize>(a: &Vec2s<W>, b: &Vec2s<W>) -> Vec2s<W> {
    [a[0] - b[0], a[1] - b[1]]
}

/// a · b with b the same in every lane.
#[inline(always)]
pub(crate) fn dot_fixed<const W: usize>(a: &Vec2s<W>, b: Vec2) -> Lanes<W> {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(crate) fn splat<const W: usize>(v: Vec2) -> Vec2s<W> {
    [Lanes::splat(v[0]), Lanes::splat(v[1])]
}

/// One lane's vector.
#[inline(always)]
pub(crate) fn lane_of<const W: usize>(v: &Vec2s<W>, lane: usize) -> Vec2 {
    [v[0].0[lane], v[1].0[lane]]
}

/// Rigid motions p ↦ origin + R p.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frames<const W: usize> {
    pub origin: Vec2s<W>,
    pub cos: Lanes<W>,
    pub sin: Lanes<W>,
}

impl<const W: usize> Frames<W> {
    /// Of poses (x, y, θ).
    #[inline(always)]
    pub fn new(Pose { x, y, theta }: &Pose<Lanes<W>>) -> Self {
        let (sin, cos) = sin_cos(*theta);
        Self {
            origin: [*x, *y],
            cos,
            sin,
        }
    }

    /// One lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Frame {
        Frame {
            origin: lane_of(&self.origin, lane),
            cos: self.cos.0[lane],
            sin: self.sin.0[lane],
        }
    }

    /// R v.
    #[inline(always)]
    pub fn turn(&self, v: &Vec2s<W>) -> Vec2s<W> {
        [
            self.cos * v[0] - self.sin * v[1],
            self.sin * v[0] + self.cos * v[1],
        ]
    }

    /// R v of a vector that is the same in every lane.
    #[inline(always)]
    pub fn turn_fixed(&self, v: Vec2) -> Vec2s<W> {
        [
            self.cos * v[0] - self.sin * v[1],
            self.sin * v[0] + self.cos * v[1],
        ]
    }

    /// Rᵀ v of a vector that is the same in every lane.
    #[inline(always)]
    pub fn turn_back_fixed(&self, v: Vec2) -> Vec2s<W> {
        [
            self.cos * v[0] + self.sin * v[1],
            self.cos * v[1] - self.sin * v[0],
        ]
    }

    /// Rᵀ v.
    #[inline(always)]
    pub fn turn_back(&self, v: &Vec2s<W>) -> Vec2s<W> {
        [
            self.cos * v[0] + self.sin * v[1],
            self.cos * v[1] - self.sin * v[0],
        ]
    }

    /// A point that is the same in every lane.
    #[inline(always)]
    pub fn point(&self, p: Vec2) -> Vec2s<W> {
        let [x, y] = self.turn_fixed(p);
        [self.origin[0] + x, self.origin[1] + y]
    }

    /// These frames as seen from `base`.
    #[inline(always)]
    pub fn seen_from(&self, base: &Self) -> Self {
        Self {
            origin: base.turn_back(&sub(&self.origin, &base.origin)),
            cos: base.cos * self.cos + base.sin * self.sin,
            sin: base.cos * self.sin - base.sin * self.cos,
        }
    }

    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let [x, y] = self.turn_back(&self.origin);
        Self {
            origin: [-x, -y],
            cos: self.cos,
            sin: -self.sin,
        }
    }
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

impl Frame {
    /// The same frame in every lane.
    #[inline(always)]
    pub fn splat<const W: usize>(&self) -> Frames<W> {
        Frames {
            origin: splat(self.origin),
            cos: Lanes::splat(self.cos),
            sin: Lanes::splat(self.sin),
        }
    }
}
