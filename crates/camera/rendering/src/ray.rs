//! Line of sight of one point of the sensor: [`Ray`].

/// A straight line from the camera's centre down to the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// The camera's centre (m).
    pub(crate) origin: [f64; 3],
    /// Displacement along x and y per metre of descent.
    pub(crate) slope: [f64; 2],
}

impl Ray {
    /// Point of the ray at height `z` (m).
    pub(crate) fn at(&self, z: f64) -> [f64; 2] {
        let descent = self.origin[2] - z;
        [
            self.origin[0] + descent * self.slope[0],
            self.origin[1] + descent * self.slope[1],
        ]
    }
}
