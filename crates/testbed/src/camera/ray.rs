//! What one point of the sensor sees: [`Ray`], and small vector algebra.

/// A straight line from the camera's centre down to the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// The camera's centre (m).
    pub(crate) origin: [f64; 3],
    /// Way along x and y per metre of descent.
    pub(crate) slope: [f64; 2],
}

impl Ray {
    /// Where the ray is at height `z` (m).
    pub(crate) fn at(&self, z: f64) -> [f64; 2] {
        let descent = self.origin[2] - z;
        [
            self.origin[0] + descent * self.slope[0],
            self.origin[1] + descent * self.slope[1],
        ]
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The vector at length 1; NaN for zero.
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
