//! Observations that move particles say nothing of quantities that are unrelated to them.

use crate::common::{settings, std};
use stickslip_filter::{BLOCK, Block, BlockMut, Draw, EnsembleShape, Model, ParticleFilter};

/// A random walk by standard normal steps, whose place is observed, and a standard normal number
/// that takes no part in it.
struct WalkAndBystander;

/// Standard deviation of the observation.
const NOISE: f64 = 0.1;

impl Model for WalkAndBystander {
    type Input = ();
    type Observation = f64;
    type Scratch = ();
    type Sums = ();

    fn columns(&self) -> usize {
        2
    }

    fn scratch(&self) {}

    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        for (lane, particle) in block.particles() {
            block.column_mut(1)[lane] = draw.normal(particle, 0);
        }
    }

    fn propagate(&self, (): &(), draw: Draw, block: &mut BlockMut<'_>, (): &mut ()) {
        for (lane, particle) in block.particles() {
            block.column_mut(0)[lane] += draw.normal(particle, 0);
        }
    }

    fn log_likelihood(&self, observed: &f64, block: &Block<'_>, out: &mut [f64]) {
        for (out, place) in out.iter_mut().zip(block.column(0)) {
            *out = -0.5 * ((place - observed) / NOISE).powi(2);
        }
    }

    fn sum(&self, (): &(), _: &Block<'_>, _: &[f64], (): &mut ()) {}

    fn ensemble(&self) -> EnsembleShape {
        EnsembleShape {
            quantities: 2,
            errors: 1,
        }
    }

    fn moves(&self, _: &f64) -> bool {
        true
    }

    fn read_ensemble(&self, observed: &f64, block: &Block<'_>, to: &mut [f64]) {
        let n = block.len();
        to[..n].copy_from_slice(block.column(0));
        to[BLOCK..][..n].copy_from_slice(block.column(1));
        for (to, place) in to[2 * BLOCK..].iter_mut().zip(block.column(0)) {
            *to = place - observed;
        }
        to[3 * BLOCK..].fill(NOISE);
    }

    fn write_ensemble(&self, from: &[f64], block: &mut BlockMut<'_>) {
        let n = block.len();
        block.column_mut(0).copy_from_slice(&from[..n]);
        block.column_mut(1).copy_from_slice(&from[BLOCK..][..n]);
    }

    fn reinitialise(&self, _: &f64, _: Draw, _: &mut BlockMut<'_>) {
        unreachable!("no observation is impossible")
    }
}

#[test]
fn what_has_no_part_in_observations_loses_its_variance_by_chance_alone() {
    let (seeds, steps) = (20, 200);
    let mut variance = 0.0;
    for seed in 0..seeds {
        let mut filter = ParticleFilter::new(WalkAndBystander, settings(500, seed)).unwrap();
        for _ in 0..steps {
            let _ = filter.step(&(), Some(&0.0));
        }
        variance += std(&filter, 1).powi(2) / seeds as f64;
    }
    // the chance correlation of N particles has variance 1/N, and takes that share at each step
    let expected = (1.0 - 1.0 / 500.0_f64).powi(steps);
    assert!(
        (variance / expected - 1.0).abs() < 0.1,
        "{variance}, {expected}"
    );
}
