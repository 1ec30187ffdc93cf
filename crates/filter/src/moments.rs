//! Weighted moments of a filter's columns.

use std::f64::consts::{PI, TAU};

use crate::{Model, ParticleFilter};

/// Sums that run side by side.
const PARTIAL: usize = 8;

impl<M: Model> ParticleFilter<M> {
    /// `sum w_i f(x_i)` over one column.
    pub fn expectation(&self, column: usize, f: impl Fn(f64) -> f64 + Sync) -> f64 {
        self.reduce(
            |block, weights| weighted_sum(block.column(column), weights, &f),
            |a, b| a + b,
        )
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

    /// The weighted mean direction of a column of angles \[rad\], in (-pi, pi]: the direction of
    /// the mean unit vector. 0 where that vector vanishes exactly.
    pub fn weighted_circular_mean(&self, column: usize) -> f64 {
        let (sin, cos) = self.reduce(
            |block, weights| {
                block
                    .column(column)
                    .iter()
                    .zip(weights)
                    .fold((0.0, 0.0), |(s, c), (&angle, w)| {
                        let (sin, cos) = libm::sincos(angle);
                        (s + w * sin, c + w * cos)
                    })
            },
            |a, b| (a.0 + b.0, a.1 + b.1),
        );
        libm::atan2(sin, cos)
    }

    /// The weighted root mean square of a column of angles \[rad\] about their mean direction,
    /// differenced on the circle.
    pub fn weighted_circular_std(&self, column: usize) -> f64 {
        self.weighted_circular_std_about(self.weighted_circular_mean(column), column)
    }

    /// The weighted root mean square of a column of angles \[rad\] about `mean`, differenced on the
    /// circle.
    pub fn weighted_circular_std_about(&self, mean: f64, column: usize) -> f64 {
        self.expectation(column, |angle| {
            let difference = wrap(angle - mean);
            difference * difference
        })
        .sqrt()
    }
}

/// `sum w_i f(x_i)` in [`PARTIAL`] partial sums: one would wait for every addition.
fn weighted_sum(x: &[f64], weights: &[f64], f: &impl Fn(f64) -> f64) -> f64 {
    let mut partial = [0.0; PARTIAL];
    for (x, weights) in x.chunks(PARTIAL).zip(weights.chunks(PARTIAL)) {
        for ((sum, &x), w) in partial.iter_mut().zip(x).zip(weights) {
            *sum += w * f(x);
        }
    }
    partial.iter().sum()
}

/// The angle in [-pi, pi] that equals `angle` on the circle.
fn wrap(angle: f64) -> f64 {
    if angle.abs() <= PI {
        angle
    } else {
        angle - TAU * libm::round(angle / TAU)
    }
}
