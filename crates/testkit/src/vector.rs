//! Algebra of vectors in the plane.

/// The third component of the cross product.
#[must_use]
pub fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The scalar product.
#[must_use]
pub fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The vector rotated by +90°.
#[must_use]
pub fn left(a: [f64; 2]) -> [f64; 2] {
    [-a[1], a[0]]
}
