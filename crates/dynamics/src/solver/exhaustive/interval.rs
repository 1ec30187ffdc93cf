//! Intervals of real numbers: [`Interval`].

use crate::solver::vector::norm;

/// Slip that rounding leaves of a foot that stands (m/s, relative where above 1).
const ROUNDING: f64 = 1e-12;

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
        // a segment between rounded ends may miss the origin that the exact one meets
        let rounding = ROUNDING * (1.0 + la.max(lb));
        let between = a[0] * b[0] + a[1] * b[1] < 0.0;
        let meets = between && turn.abs() <= rounding * norm(&[b[0] - a[0], b[1] - a[1]]);
        if la < rounding || lb < rounding || meets {
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

    /// Returns true if it contains no number.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn range(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        let Interval { low, high } = Interval::of_directions([0.0, 2.0], a, b);
        [low, high]
    }

    /// A foot stands somewhere on the segment, or rounding hides that it does, however short it is.
    #[test]
    fn slips_through_rest_may_have_any_direction() {
        for length in [1.0, 1e-3, 1e-8, 1e-11] {
            for off in [0.0, 1e-16, -1e-14] {
                let (a, b) = ([length, off], [-0.7 * length, off]);
                assert_eq!(range(a, b), [-2.0, 2.0], "{length} {off}");
            }
        }
    }

    #[test]
    fn slips_clear_of_rest_have_the_directions_between_their_ends() {
        assert_eq!(range([3.0, 4.0], [-3.0, 4.0]), [1.6, 2.0]);
        assert_eq!(range([-1e-5, -1e-5], [1e-5, -1e-5])[0], -2.0);
        assert!(range([-1e-5, -1e-5], [1e-5, -1e-5])[1] < -1.4);
    }
}
