//! Noise of one measured pose: [`PoseCovariance`].

use stickslip_dynamics::Pose;

use crate::range::Unit;

/// Least conditional variance of a number given the others, as a share of its variance. Less is
/// rounding, or the matrix is no covariance.
const LEAST_LEFT: f64 = 1e-12;

/// The covariance of the errors of a measured pose, in the world's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseCovariance {
    /// Variance of x (m²).
    pub x: f64,
    /// Variance of y (m²).
    pub y: f64,
    /// Variance of θ (rad²).
    pub theta: f64,
    /// Covariance of x and y (m²).
    pub x_y: f64,
    /// Covariance of x and θ (m rad).
    pub x_theta: f64,
    /// Covariance of y and θ (m rad).
    pub y_theta: f64,
}

/// Cholesky factor L of the covariance in the order θ, x, y; its diagonal is stored inverted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factor {
    per_theta: f64,
    x_by_theta: f64,
    y_by_theta: f64,
    per_x: f64,
    y_by_x: f64,
    per_y: f64,
}

impl PoseCovariance {
    /// Returns true if this can be a covariance: finite, positive definite, with plausible standard
    /// deviations.
    ///
    /// ```
    /// use stickslip::PoseCovariance;
    /// let round = PoseCovariance { x: 1e-8, y: 1e-8, theta: 1e-6, ..PoseCovariance::default() };
    /// assert!(round.is_valid());
    /// assert!(!PoseCovariance { x_y: 1e-8, ..round }.is_valid());
    /// ```
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.factor().is_some()
    }

    /// Returns true if all numbers are 0, by which ROS marks an unknown covariance.
    #[must_use]
    pub fn is_unknown(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the Cholesky factor, or `None` if this is no covariance.
    pub(crate) fn factor(&self) -> Option<Factor> {
        let std = |variance: f64, unit: Unit| {
            let std = variance.sqrt();
            (std > unit.least() && unit.holds(std)).then_some(std)
        };
        let theta = std(self.theta, Unit::Radian)?;
        std(self.x, Unit::Metre)?;
        std(self.y, Unit::Metre)?;
        let left = |left: f64, of: f64| (left > LEAST_LEFT * of).then(|| left.sqrt());
        let (x_by_theta, y_by_theta) = (self.x_theta / theta, self.y_theta / theta);
        let x = left(self.x - x_by_theta * x_by_theta, self.x)?;
        let y_by_x = (self.x_y - y_by_theta * x_by_theta) / x;
        let y = left(self.y - y_by_theta * y_by_theta - y_by_x * y_by_x, self.y)?;
        Some(Factor {
            per_theta: 1.0 / theta,
            x_by_theta,
            y_by_theta,
            per_x: 1.0 / x,
            y_by_x,
            per_y: 1.0 / y,
        })
    }
}

impl Factor {
    /// Whitens an error: returns independent numbers of variance 1, that of θ, then of x, then of
    /// y. Their squares sum to the squared Mahalanobis distance.
    #[inline(always)]
    pub(crate) fn whitened<T>(&self, error: Pose<T>) -> [T; 3]
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Sub<Output = T>,
    {
        let theta = error.theta * self.per_theta;
        let x = (error.x - theta * self.x_by_theta) * self.per_x;
        let y = (error.y - theta * self.y_by_theta - x * self.y_by_x) * self.per_y;
        [theta, x, y]
    }

    /// Returns the error that independent numbers of variance 1 stand for, given in the order x, y,
    /// θ.
    pub(crate) fn drawn(&self, [x, y, theta]: [f64; 3]) -> Pose {
        Pose {
            x: self.x_by_theta * theta + x / self.per_x,
            y: self.y_by_theta * theta + self.y_by_x * x + y / self.per_y,
            theta: theta / self.per_theta,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND: PoseCovariance = PoseCovariance {
        x: 4e-8,
        y: 9e-8,
        theta: 1e-6,
        x_y: 3e-8,
        x_theta: -1e-7,
        y_theta: 5e-8,
    };

    /// eᵀ C⁻¹ e by the cofactors of C.
    fn mahalanobis(c: &PoseCovariance, e: &Pose) -> f64 {
        let m = [
            [c.x, c.x_y, c.x_theta],
            [c.x_y, c.y, c.y_theta],
            [c.x_theta, c.y_theta, c.theta],
        ];
        let cofactor = |i: usize, j: usize| {
            let [a, b] = [(i + 1) % 3, (i + 2) % 3];
            let [p, q] = [(j + 1) % 3, (j + 2) % 3];
            m[a][p] * m[b][q] - m[a][q] * m[b][p]
        };
        let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
        let e = [e.x, e.y, e.theta];
        let terms = (0..9).map(|k| e[k / 3] * cofactor(k / 3, k % 3) * e[k % 3]);
        terms.sum::<f64>() / determinant
    }

    #[test]
    fn whitened_squares_sum_to_the_mahalanobis_distance() {
        let factor = ROUND.factor().unwrap();
        for error in [[1e-4, 0.0, 0.0], [0.0, -2e-4, 1e-3], [3e-4, 1e-4, -2e-3]] {
            let error = Pose::new(error[0], error[1], error[2]);
            let found: f64 = factor.whitened(error).iter().map(|n| n * n).sum();
            let expected = mahalanobis(&ROUND, &error);
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// The sum of squares of the drawn unit errors is the covariance.
    #[test]
    fn drawn_errors_have_the_covariance() {
        let factor = ROUND.factor().unwrap();
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let drawn = units.map(|unit| factor.drawn(unit));
        let sum = |of: fn(&Pose) -> f64| drawn.iter().map(of).sum::<f64>();
        for (found, expected) in [
            (sum(|e| e.x * e.x), ROUND.x),
            (sum(|e| e.y * e.y), ROUND.y),
            (sum(|e| e.theta * e.theta), ROUND.theta),
            (sum(|e| e.x * e.y), ROUND.x_y),
            (sum(|e| e.x * e.theta), ROUND.x_theta),
            (sum(|e| e.y * e.theta), ROUND.y_theta),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn only_covariances_are_valid() {
        let of = |change: fn(&mut PoseCovariance)| {
            let mut covariance = ROUND;
            change(&mut covariance);
            covariance
        };
        for wrong in [
            PoseCovariance::default(),
            of(|c| c.x = f64::NAN),
            of(|c| c.y_theta = f64::INFINITY),
            of(|c| c.y = -c.y),
            of(|c| c.theta = 0.0),
            // perfectly correlated, and more
            of(|c| c.x_y = 6e-8),
            of(|c| c.x_theta = 3e-7),
            of(|c| c.x = 1e-19),
            of(|c| c.theta = 1e13),
        ] {
            assert!(!wrong.is_valid(), "{wrong:?}");
        }
        assert!(ROUND.is_valid() && !ROUND.is_unknown());
        assert!(PoseCovariance::default().is_unknown());
    }
}
