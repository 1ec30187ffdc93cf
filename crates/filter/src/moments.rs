//! Weighted moments of a filter's columns.

use std::f64::consts::{PI, TAU};

use crate::{Model, ParticleFilter};

impl<M: Model> ParticleFilter<M> {
    /// `sum w_i f(x_i)` over one column.
    pub fn expectation(&self, column: usize, f: impl Fn(f64) -> f64 + Sync) -> f64 {
        self.reduce(|block, weights| block.column(column).iter().zip(weights).fold(0.0, |sum, (&x, w)| sum + w * f(x)), |a, b| a + b)
    }

    /// The weighted mean of a column.
    pub fn weighted_mean(&self, column: usize) -> f64 {
        self.expectation(column, |x| x)
    }

    /// The weighted standard deviation of a column about its mean.
    pub fn weighted_std(&self, column: usize) -> f64 {
        let mean = self.weighted_mean(column);
        self.expectation(column, |x| (x - mean) * (x - mean)).sqrt()
    }

    /// The weighted mean direction of a column of angles \[rad\], in (-pi, pi]: the direction of the mean unit
    /// vector. 0 where that vector vanishes exactly.
    pub fn weighted_circular_mean(&self, column: usize) -> f64 {
        let (sin, cos) = self.reduce(
            |block, weights| {
                block.column(column).iter().zip(weights).fold((0.0, 0.0), |(s, c), (&angle, w)| {
                    let (sin, cos) = libm::sincos(angle);
                    (s + w * sin, c + w * cos)
                })
            },
            |a, b| (a.0 + b.0, a.1 + b.1),
        );
        libm::atan2(sin, cos)
    }

    /// The weighted root mean square of a column of angles \[rad\] about their mean direction, differenced on the
    /// circle.
    pub fn weighted_circular_std(&self, column: usize) -> f64 {
        let mean = self.weighted_circular_mean(column);
        self.expectation(column, |angle| {
            let difference = wrap(angle - mean);
            difference * difference
        })
        .sqrt()
    }
}

/// The angle in [-pi, pi] that equals `angle` on the circle.
fn wrap(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { angle - TAU * libm::round(angle / TAU) }
}
