//! Intervals of real numbers: [`Interval`].

use crate::solver::vector::norm;

/// The numbers from `low` to `high`; none where `low` is the larger.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Between two numbers in either order.
    pub fn hull(a: f64, b: f64) -> Self {
        Self {
            low: a.min(b),
            high: a.max(b),
        }
    }

    /// Range of q·s/|s| for s on the segment from a to b; all that is possible where the segment
    /// meets the origin.
    pub fn of_directions(q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Self {
        let cross = |p: [f64; 2], r: [f64; 2]| p[0] * r[1] - p[1] * r[0];
        let size = norm(&q);
        let (la, lb) = (norm(&a), norm(&b));
        let turn = cross(a, b);
        let opposite = a[0] * b[0] + a[1] * b[1] < 0.0 && turn.abs() <= 1e-12 * la * lb;
        if la < 1e-13 || lb < 1e-13 || opposite {
            return Self {
                low: -size,
                high: size,
            };
        }
        let mut range = Self::hull(
            (q[0] * a[0] + q[1] * a[1]) / la,
            (q[0] * b[0] + q[1] * b[1]) / lb,
        );
        // q, or its opposite, between the two directions
        let (qa, qb) = (cross(a, q) * turn, cross(q, b) * turn);
        if qa > 0.0 && qb > 0.0 {
            range.high = size;
        }
        if qa < 0.0 && qb < 0.0 {
            range.low = -size;
        }
        range
    }

    /// Whether it has no number.
    pub fn is_empty(&self) -> bool {
        self.low > self.high
    }

    /// Its middle.
    pub fn midpoint(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Removes the numbers x where slope x + offset < 0.
    pub fn clip(&mut self, slope: f64, offset: f64) {
        if slope.abs() < 1e-14 {
            if offset < 0.0 {
                (self.low, self.high) = (1.0, 0.0);
            }
        } else if slope > 0.0 {
            self.low = self.low.max(-offset / slope);
        } else {
            self.high = self.high.min(-offset / slope);
        }
    }
}
