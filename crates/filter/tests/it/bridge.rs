//! Observations that move particles, against the exact posterior.

use crate::common::{mean, settings, std};
use stickslip_filter::{
    BLOCK, Block, BlockMut, Draw, EnsembleShape, Model, ParticleFilter, WeightUpdate,
};

/// Two numbers that stay, standard normal before; their sum is observed with normal noise.
struct TwoNumbers {
    noise: f64,
    moves: bool,
}

const OBSERVED: f64 = 1.2;

impl TwoNumbers {
    /// Errors of a block's particles.
    fn errors(observed: f64, block: &Block<'_>) -> Vec<f64> {
        let sums = block.column(0).iter().zip(block.column(1));
        sums.map(|(a, b)| a + b - observed).collect()
    }

    /// Mean and variance of each number after one observation, and ln of its density.
    fn exact(&self) -> (f64, f64, f64) {
        let variance = 2.0 + self.noise * self.noise;
        let density = -0.5 * (OBSERVED * OBSERVED / variance)
            - 0.5 * libm::log(std::f64::consts::TAU * variance);
        (OBSERVED / variance, 1.0 - 1.0 / variance, density)
    }
}

impl Model for TwoNumbers {
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
            let numbers = draw.normals::<2>(particle, 0);
            for (column, number) in numbers.into_iter().enumerate() {
                block.column_mut(column)[lane] = number;
            }
        }
    }

    fn propagate(&self, (): &(), _: Draw, _: &mut BlockMut<'_>, (): &mut ()) {}

    fn log_likelihood(&self, observed: &f64, block: &Block<'_>, out: &mut [f64]) {
        let constant = -libm::log(self.noise * std::f64::consts::TAU.sqrt());
        for (out, error) in out.iter_mut().zip(Self::errors(*observed, block)) {
            *out = constant - 0.5 * (error / self.noise).powi(2);
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
        self.moves
    }

    fn read_ensemble(&self, observed: &f64, block: &Block<'_>, to: &mut [f64]) {
        let n = block.len();
        to[..n].copy_from_slice(block.column(0));
        to[BLOCK..][..n].copy_from_slice(block.column(1));
        to[2 * BLOCK..][..n].copy_from_slice(&Self::errors(*observed, block));
        to[3 * BLOCK..].fill(self.noise);
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

/// Over 200 seeds: root mean square distance of the mean from the exact one, mean variance, mean of the
/// evidence, all of the first number after one observation.
fn after(noise: f64, moves: bool) -> [f64; 3] {
    let (exact, _, density) = TwoNumbers { noise, moves }.exact();
    let seeds = 200;
    let mut sums = [0.0; 3];
    for seed in 0..seeds {
        let model = TwoNumbers { noise, moves };
        let mut filter = ParticleFilter::new(model, settings(500, seed)).unwrap();
        let report = filter.step(&(), Some(&OBSERVED));
        let WeightUpdate::Weighed { log_evidence } = report.weight_update else {
            panic!("{report:?}");
        };
        let error = mean(&filter, 0) - exact;
        let variance = std(&filter, 0) * std(&filter, 0);
        let evidence = libm::exp(log_evidence - density);
        for (sum, x) in sums.iter_mut().zip([error * error, variance, evidence]) {
            *sum += x / seeds as f64;
        }
    }
    [sums[0].sqrt(), sums[1], sums[2]]
}

#[test]
fn an_observation_that_is_precise_beside_the_particles_leaves_the_exact_belief() {
    let noise = 0.01;
    let (_, exact, _) = TwoNumbers { noise, moves: true }.exact();
    let [error, variance, evidence] = after(noise, true);
    // of 500 independent particles from the posterior the mean's standard error is 0.032
    assert!(error < 0.045, "{error}");
    assert!((variance / exact - 1.0).abs() < 0.04, "{variance}, {exact}");
    // the evidence is estimated without bias; its standard error over the seeds is some 3 %
    assert!((evidence - 1.0).abs() < 0.15, "{evidence}");

    // weighing alone leaves three of them
    let [error, variance, _] = after(noise, false);
    assert!(error > 0.2 && variance < 0.9 * exact, "{error}, {variance}");
}

#[test]
fn an_observation_that_leaves_enough_particles_moves_none() {
    let columns = |moves: bool| {
        let model = TwoNumbers { noise: 5.0, moves };
        let mut filter = ParticleFilter::new(model, settings(500, 3)).unwrap();
        let _ = filter.step(&(), Some(&OBSERVED));
        let particles: Vec<f64> = filter.particles().column(0).collect();
        (particles, filter.weights().clone())
    };
    assert_eq!(columns(true), columns(false));
}
