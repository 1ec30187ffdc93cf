//! Algebra of vectors in the plane.

pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The vector rotated by +90°.
pub(crate) fn left(a: [f64; 2]) -> [f64; 2] {
    [-a[1], a[0]]
}
