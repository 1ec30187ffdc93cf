//! Moments of one column, for quantities that no [`Model::Sums`] has.

use std::f64::consts::{PI, TAU};

use crate::filter::ParticleFilter;
use crate::model::Model;

/// Independent partial sums: a single one would wait for every addition.
const PARTIAL: usize = 8;

impl<M: Model> ParticleFilter<M> {
    /// `Σ w_i f(x_i)` over one column; the same bits on any number of threads.
    pub fn expectation(&self, column: usize, f: impl Fn(f64) -> f64 + Sync) -> f64 {
        let weights = self.weights().weights();
        self.particles().reduce(
            |block| weighted_sum(block.column(column), &weights[block.range()], &f),
            |a, b| a + b,
        )
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
