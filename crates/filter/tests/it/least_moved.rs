//! Observations that say little, and move particles all the same.

use crate::common::{mean, settings, std};
use stickslip_filter::{
    BLOCK, Block, BlockMut, Draw, EnsembleShape, Model, ParticleFilter, Streams,
};

/// A number that stays; observed with normal noise, or wrongly.
struct Number {
    /// A particle's number, from a standard normal one.
    number: fn(u32, f64) -> f64,
    least: f64,
    /// −ln of the likelihood, by something else, of particles near 0.
    against_near: f64,
}

const NOISE: f64 = 3.0;

/// Likelihood of an observation that is wrong, relative to that of a perfect one.
const WRONG: f64 = 1e-7;

impl Model for Number {
    type Input = ();
    type Observation = f64;
    type Scratch = ();
    type Sums = ();

    fn columns(&self) -> usize {
        1
    }

    fn scratch(&self) {}

    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        for (lane, particle) in block.particles() {
            let drawn = draw.normal(particle, 0);
            block.column_mut(0)[lane] = (self.number)(particle, drawn);
        }
    }

    fn propagate(&self, (): &(), _: Draw, _: &mut BlockMut<'_>, (): &mut ()) {}

    fn log_likelihood(&self, observed: &f64, block: &Block<'_>, out: &mut [f64]) {
        self.resetting_log_likelihood(observed, block, out);
        for (out, x) in out.iter_mut().zip(block.column(0)) {
            *out -= if x.abs() < 100.0 {
                self.against_near
            } else {
                0.0
            };
        }
    }

    fn resetting_log_likelihood(&self, observed: &f64, block: &Block<'_>, out: &mut [f64]) {
        for (out, x) in out.iter_mut().zip(block.column(0)) {
            let error = (x - observed) / NOISE;
            *out = libm::log(libm::exp(-0.5 * error * error) + WRONG);
        }
    }

    fn sum(&self, (): &(), _: &Block<'_>, _: &[f64], (): &mut ()) {}

    fn ensemble(&self) -> EnsembleShape {
        EnsembleShape {
            quantities: 1,
            errors: 1,
        }
    }

    fn moves(&self, _: &f64) -> bool {
        true
    }

    fn least_moved(&self, _: &f64) -> f64 {
        self.least
    }

    fn read_ensemble(&self, observed: &f64, block: &Block<'_>, to: &mut [f64]) {
        let n = block.len();
        to[..n].copy_from_slice(block.column(0));
        for (to, x) in to[BLOCK..].iter_mut().zip(block.column(0)) {
            *to = x - observed;
        }
        to[2 * BLOCK..].fill(NOISE);
    }

    fn write_ensemble(&self, from: &[f64], block: &mut BlockMut<'_>) {
        let n = block.len();
        block.column_mut(0).copy_from_slice(&from[..n]);
    }

    fn reinitialise(&self, _: &f64, _: Draw, _: &mut BlockMut<'_>) {
        unreachable!("no observation is impossible")
    }
}

/// Results over ten seeds of 100 particles, after 2000 observations: the root mean square distance
/// of the mean from the exact one, in exact standard deviations, and the ratio of the mean variance
/// to the exact one.
fn after_many(least: f64) -> [f64; 2] {
    let (seeds, count) = (10, 2000_u32);
    let exact = 1.0 / (1.0 + f64::from(count) / (NOISE * NOISE));
    let mut sums = [0.0; 2];
    for seed in 0..seeds {
        let model = Number {
            number: |_, drawn| drawn,
            least,
            against_near: 0.0,
        };
        let mut filter = ParticleFilter::new(model, settings(100, seed)).unwrap();
        let noise = Streams::new(1000 + seed);
        let mut sum = 0.0;
        for k in 0..count {
            let [observed] = noise
                .normals::<1>(u64::from(k), 0, 0)
                .map(|n| 0.7 + NOISE * n);
            sum += observed;
            let _ = filter.step(&(), Some(&observed));
        }
        let error = mean(&filter, 0) - exact * sum / (NOISE * NOISE);
        let variance = std(&filter, 0).powi(2);
        for (sum, x) in sums.iter_mut().zip([error * error, variance]) {
            *sum += x / exact / seeds as f64;
        }
    }
    [sums[0].sqrt(), sums[1]]
}

#[test]
fn many_observations_that_each_tell_little_leave_the_exact_belief() {
    let [error, variance] = after_many(0.9);
    assert!(error < 0.25, "{error}");
    assert!((variance - 1.0).abs() < 0.15, "{variance}");

    // weighing alone, which each of them allows, leaves the few that were near
    let [error, _] = after_many(0.0);
    assert!(error > 0.4, "{error}");
}

#[test]
fn a_particle_that_lies_far_is_weighed_out_and_not_brought_near() {
    let model = Number {
        number: |particle, drawn| if particle == 0 { 1000.0 } else { drawn },
        least: 0.9,
        against_near: 0.0,
    };
    let mut filter = ParticleFilter::new(model, settings(500, 1)).unwrap();
    let _ = filter.step(&(), Some(&0.5));
    assert_eq!(filter.particles().value(0, 0), 1000.0);
    // by a tenth of what tells against it, it would keep a fifth of a particle's weight
    assert!(filter.weights().weights()[0] < 1e-8);
}

#[test]
fn what_tells_against_all_that_are_near_moves_none() {
    // all but ten lie far, and what is not moved tells against those ten by e⁻¹⁰⁰
    let model = Number {
        number: |particle, _| if particle < 490 { 1000.0 } else { 0.0 },
        least: 0.9,
        against_near: 100.0,
    };
    let mut filter = ParticleFilter::new(model, settings(500, 1)).unwrap();
    let _ = filter.step(&(), Some(&0.5));
    assert_eq!(filter.particles().value(0, 0), 1000.0);
    assert_eq!(filter.particles().value(499, 0), 0.0);
    let weights = filter.weights().weights();
    assert!(
        weights[0] > 0.9 / 490.0 && weights[499] < 1e-30,
        "{weights:?}"
    );
}
