//! Poses as points, and the moments of a group of them: [`Moments`].

/// x, y and ρθ about some pose (m): distances of poses as lengths.
pub(crate) type Point = [f64; 3];

/// Power iterations: any axis near the longest one serves.
const ITERATIONS: usize = 16;

/// Weight, mean and covariance of a group.
pub(crate) struct Moments {
    /// Sum of the weights.
    pub weight: f64,
    /// Mean (m).
    pub mean: Point,
    /// Covariance (m²).
    pub covariance: [Point; 3],
}

impl Moments {
    /// The moments of weights and points.
    pub fn of(members: impl Iterator<Item = (f64, Point)> + Clone) -> Self {
        let (mut weight, mut first) = (0.0, [0.0; 3]);
        for (w, point) in members.clone() {
            weight += w;
            first
                .iter_mut()
                .zip(point)
                .for_each(|(sum, d)| *sum += w * d);
        }
        let mean = first.map(|sum| sum / weight);
        let mut covariance = [[0.0; 3]; 3];
        for (w, point) in members {
            let d = minus(point, mean);
            for (row, di) in covariance.iter_mut().zip(d) {
                row.iter_mut()
                    .zip(d)
                    .for_each(|(c, dj)| *c += w * di * dj / weight);
            }
        }
        Self {
            weight,
            mean,
            covariance,
        }
    }

    /// Returns the axis of greatest variance, by power iteration; `None` if all is one point.
    pub fn longest_axis(&self) -> Option<Point> {
        let c = &self.covariance;
        let widest = (0..3).max_by(|i, j| c[*i][*i].total_cmp(&c[*j][*j]))?;
        let mut axis = c[widest];
        for _ in 0..ITERATIONS {
            let length = squared(axis).sqrt();
            if length == 0.0 || !length.is_finite() {
                return None;
            }
            let unit = axis.map(|d| d / length);
            axis = [0, 1, 2].map(|i| dot(c[i], unit));
        }
        let length = squared(axis).sqrt();
        (length > 0.0).then(|| axis.map(|d| d / length))
    }
}

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn squared(a: Point) -> f64 {
    dot(a, a)
}
