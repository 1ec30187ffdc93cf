//! Vectors of the plane: [`Vec2`], one or a vector per lane.

use std::ops::{Add, Mul, Neg, Sub};

use stickslip_lanes::Lanes;

/// A point or a vector (m), or a direction.
pub(crate) type Vec2<T = f64> = [T; 2];

/// A number that combines with its own kind and with an `S`: an `f64`, or lanes, whose partner may
/// be an `f64` that is the same in every lane.
pub(crate) trait Number<S = Self>:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Add<S, Output = Self>
    + Sub<S, Output = Self>
    + Mul<S, Output = Self>
{
}

impl Number for f64 {}
impl<const W: usize> Number for Lanes<W> {}
impl<const W: usize> Number<f64> for Lanes<W> {}

#[inline(always)]
pub(crate) fn add<T: Number<S>, S: Copy>(a: Vec2<T>, b: Vec2<S>) -> Vec2<T> {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
pub(crate) fn sub<T: Number<S>, S: Copy>(a: Vec2<T>, b: Vec2<S>) -> Vec2<T> {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
pub(crate) fn scale<T: Number<S>, S: Copy>(s: T, v: Vec2<S>) -> Vec2<T> {
    [s * v[0], s * v[1]]
}

#[inline(always)]
pub(crate) fn negate<T: Number>(v: Vec2<T>) -> Vec2<T> {
    [-v[0], -v[1]]
}

#[inline(always)]
pub(crate) fn dot<T: Number<S>, S: Copy>(a: Vec2<T>, b: Vec2<S>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(crate) fn cross<T: Number<S>, S: Copy>(a: Vec2<T>, b: Vec2<S>) -> T {
    a[0] * b[1] - a[1] * b[0]
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

/// Copies the vector into every lane.
#[inline(always)]
pub(crate) fn splat<const W: usize>(v: Vec2) -> Vec2<Lanes<W>> {
    [Lanes::splat(v[0]), Lanes::splat(v[1])]
}

/// One lane's vector.
#[inline(always)]
pub(crate) fn lane_of<const W: usize>(v: &Vec2<Lanes<W>>, lane: usize) -> Vec2 {
    [v[0].0[lane], v[1].0[lane]]
}

/// Mean of some points and their largest distance from it: a disc that holds them.
pub(crate) fn bounding_disc(points: impl Iterator<Item = Vec2> + Clone) -> (Vec2, f64) {
    let count = points.clone().count() as f64;
    let centre = points.clone().fold([0.0; 2], |sum, p| {
        [sum[0] + p[0] / count, sum[1] + p[1] / count]
    });
    let radius = points.map(|p| length(sub(p, centre))).fold(0.0, f64::max);
    (centre, radius)
}
