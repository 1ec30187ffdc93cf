//! Random force of the robust model, as particles meet it before anything is learned of it.

use std::sync::Mutex;

use crate::common::{PARTICLES, run_from_rest, setup};
use stickslip::dynamics::{Particles, StepInput};
use stickslip::{Observer, SolvedStep, Uncertainty};

/// `force_std` of all runs here.
const TOLD: f64 = 0.25;

/// Impulse along x in the first step in which a force acts on a particle, as a share of its μ_s m g
/// h.
#[derive(Debug)]
struct FirstForce(Mutex<[f64; PARTICLES]>);

impl Observer for FirstForce {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn before_step(&self, input: &StepInput, particles: &[Particles<8>]) {
        let mut shares = self.0.lock().expect("no test panicked here");
        let object = setup(&[]).scene.object;
        for (chunk, shares) in particles.iter().zip(shares.chunks_mut(8)) {
            let forces = chunk.applied.fx.0.iter().zip(&chunk.friction.mu_s.0);
            for (share, (fx, mu_s)) in shares.iter_mut().zip(forces) {
                if *share == 0.0 {
                    *share = fx / (mu_s * object.mass * 9.81 * input.h);
                }
            }
        }
    }
}

/// Mean square of the force on particles that a pusher comes near, over many seeds, with the camera
/// `seeing` them or not.
fn mean_square(uncertainty: Uncertainty, seeing: bool) -> f64 {
    let mut setup = setup(&[]);
    setup.uncertainty = Uncertainty {
        force_std: TOLD,
        ..uncertainty
    };
    let mut squares = Vec::new();
    for seed in 0..100 {
        let force = FirstForce(Mutex::new([0.0; PARTICLES]));
        run_from_rest(&setup, seed, seeing, &force);
        let shares = force.0.into_inner().expect("no test panicked here");
        squares.extend(shares.iter().filter(|x| **x != 0.0).map(|x| x * x));
    }
    assert!(squares.len() > 3000, "{} forces", squares.len());
    squares.iter().sum::<f64>() / squares.len() as f64
}

/// Uncertainty with equal rigs.
fn alike() -> Uncertainty {
    Uncertainty {
        well_measured: 1.0,
        ..Uncertainty::default()
    }
}

#[test]
fn random_force_is_as_large_as_told() {
    let told = TOLD * TOLD;
    let ratio = mean_square(alike(), false) / told;
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
}

#[test]
fn random_force_is_smaller_on_rigs_that_are_measured_well_in_the_dark_alone() {
    // all rigs lie between the two kinds, where b of (36) is (1 + w)/2; the variance is b times as
    // large
    let uncertainty = Uncertainty {
        roughness: 1e-6,
        ..Uncertainty::default()
    };
    let between = 0.5 * (1.0 + uncertainty.well_measured);
    for (seeing, expected) in [(true, 1.0), (false, between)] {
        let ratio = mean_square(uncertainty, seeing) / (TOLD * TOLD);
        assert!((ratio / expected - 1.0).abs() < 0.08, "{ratio}, {expected}");
    }
}
