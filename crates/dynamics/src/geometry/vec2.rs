//! Vectors of the plane as `[f64; 2]`.

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
