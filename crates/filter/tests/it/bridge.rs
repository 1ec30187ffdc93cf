//! Observations that move particles, against the exact posterior.

use crate::common::{mean, settings, std};
use stickslip_filter::{
    BLOCK, Block, BlockMut, Draw, EnsembleShape, Model, ParticleFilter, WeightUpdate,
};

/// Two numbers that stay, standard normal before; sums of shares of them are observed with normal
/// noise.
struct TwoNumbers {
    sensors: Vec<Sensor>,
    moves: bool,
}

/// Sensor whose observation, [`OBSERVED`], is a given share of each number, plus noise.
struct Sensor {
    shares: [f64; 2],
    noise: f64,
}

const OBSERVED: f64 = 1.2;

/// The sum of both.
fn sum_with(noise: f64) -> Vec<Sensor> {
    let shares = [1.0, 1.0];
    vec![Sensor { shares, noise }]
}

impl TwoNumbers {
    /// Mean and variance of each number after the sum was observed once, and ln of its density.
    fn exact(noise: f64) -> (f64, f64, f64) {
        let variance = 2.0 + noise * noise;
        let density = -0.5 * (OBSERVED * OBSERVED / variance)
            - 0.5 * libm::log(std::f64::consts::TAU * variance);
        (OBSERVED / variance, 1.0 - 1.0 / variance, density)
    }
}

impl Sensor {
    /// Errors of a block's particles.
    fn errors(&self, observed: f64, block: &Block<'_>) -> Vec<f64> {
        let [a, b] = self.shares;
        let numbers = block.column(0).iter().zip(block.column(1));
        numbers.map(|(x, y)| a * x + b * y - observed).collect()
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
        out.fill(0.0);
        for sensor in &self.sensors {
            let constant = -libm::log(sensor.noise * std::f64::consts::TAU.sqrt());
            for (out, error) in out.iter_mut().zip(sensor.errors(*observed, block)) {
                *out += constant - 0.5 * (error / sensor.noise).powi(2);
            }
        }
    }

    fn sum(&self, (): &(), _: &Block<'_>, _: &[f64], (): &mut ()) {}

    fn ensemble(&self) -> EnsembleShape {
        EnsembleShape {
            quantities: 2,
            errors: self.sensors.len(),
        }
    }

    fn moves(&self, _: &f64) -> bool {
        self.moves
    }

    fn read_ensemble(&self, observed: &f64, block: &Block<'_>, to: &mut [f64]) {
        let n = block.len();
        to[..n].copy_from_slice(block.column(0));
        to[BLOCK..][..n].copy_from_slice(block.column(1));
        let (errors, noise) = to[2 * BLOCK..].split_at_mut(self.sensors.len() * BLOCK);
        for ((sensor, errors), noise) in (self.sensors.iter())
            .zip(errors.chunks_mut(BLOCK))
            .zip(noise.chunks_mut(BLOCK))
        {
            errors[..n].copy_from_slice(&sensor.errors(*observed, block));
            noise.fill(sensor.noise);
        }
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

/// Over 200 seeds: root mean square distance of the mean from the exact one, mean variance, mean of
/// the evidence, all of the first number after one observation.
fn after(noise: f64, moves: bool) -> [f64; 3] {
    let (exact, _, density) = TwoNumbers::exact(noise);
    let seeds = 200;
    let mut sums = [0.0; 3];
    for seed in 0..seeds {
        let sensors = sum_with(noise);
        let model = TwoNumbers { sensors, moves };
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
    let (_, exact, _) = TwoNumbers::exact(noise);
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
        let sensors = sum_with(5.0);
        let model = TwoNumbers { sensors, moves };
        let mut filter = ParticleFilter::new(model, settings(500, 3)).unwrap();
        let _ = filter.step(&(), Some(&OBSERVED));
        let particles: Vec<f64> = filter.particles().column(0).collect();
        (particles, filter.weights().clone())
    };
    assert_eq!(columns(true), columns(false));
}

#[test]
fn two_sensors_count_by_their_own_noise() {
    // each number alone: its variance after is n² / (1 + n²)
    let noise = [0.02, 0.5];
    let seeds = 100;
    let mut variances = [0.0; 2];
    for seed in 0..seeds {
        let sensor = |shares, noise| Sensor { shares, noise };
        let model = TwoNumbers {
            sensors: vec![sensor([1.0, 0.0], noise[0]), sensor([0.0, 1.0], noise[1])],
            moves: true,
        };
        let mut filter = ParticleFilter::new(model, settings(500, seed)).unwrap();
        let _ = filter.step(&(), Some(&OBSERVED));
        for (k, variance) in variances.iter_mut().enumerate() {
            *variance += std(&filter, k).powi(2) / seeds as f64;
        }
    }
    for (variance, noise) in variances.into_iter().zip(noise) {
        let exact = noise * noise / (1.0 + noise * noise);
        assert!((variance / exact - 1.0).abs() < 0.06, "{variance}, {exact}");
    }
}
