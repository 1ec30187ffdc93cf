//! Coverage of 90 % intervals over sets of simulated pushes of one plate whose friction is drawn
//! from the prior. It is counted for the values that predict best and for the constants:
//! `cargo run --release -p stickslip-fit --example recovery -- 30 model`.
//!
//! `testbed` is another physics, and a third argument is the number of pushes in a set.
#![allow(
    clippy::unwrap_used,
    reason = "a simulated set that cannot be made ends it"
)]

#[path = "../tests/it/common/mod.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod common;

use common::{pushes, rig_tripod_radius, setup};
use stickslip_evaluation::Physics;
use stickslip_filter::Streams;
use stickslip_fit::{FitOptions, FittedParameter, Parameter, fit};

/// Pushes of a set, unless the third argument says another number.
const PUSHES: usize = 8;

/// Standard deviations on either side that hold 90 % of a normal distribution.
const NINETY_PERCENT: f64 = 1.645;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let sets: u64 = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(30);
    let physics = match arguments.next().as_deref() {
        Some("testbed") => Physics::Testbed,
        _ => Physics::Model,
    };
    let pushes_of_a_set = arguments.next().and_then(|n| n.parse().ok());
    let options = FitOptions {
        parameters: vec![Parameter::MuP, Parameter::TripodRadius],
        seed: 0,
    };
    let mut errors: [Vec<[f64; 2]>; 2] = Default::default();
    let mut held = [0; 2];
    for set in 0..sets {
        let truth = setup().drawn_friction(Streams::new(1000 + set).normals(0, 0, 0));
        let seed = 100 * set;
        let pushes = pushes(truth, physics, pushes_of_a_set.unwrap_or(PUSHES), seed);
        let fit = fit(&pushes, &options, &|_, _| ()).expect("a fit");
        let d_tri = match physics {
            Physics::Model => truth.d_tri,
            Physics::Testbed => rig_tripod_radius(truth, seed),
        };
        for (k, truth) in [truth.mu_p, d_tri].into_iter().enumerate() {
            let fitted = &fit.parameters[k];
            let constant = fitted.constant.expect("a constant");
            held[k] += usize::from((constant.low_90..=constant.high_90).contains(&truth));
            errors[k].push(error(fitted, truth));
        }
        println!(
            "set {set}: mu_p {:.3}, tripod_radius {:.4}; errors and spreads of logarithms {:.3?} {:.3?}, drift {:.4}",
            truth.mu_p, d_tri, errors[0][set as usize], errors[1][set as usize], fit.noise.drift
        );
    }
    for (k, name) in ["mu_p", "tripod_radius"].into_iter().enumerate() {
        let (said, held) = (summary(&errors[k]), held[k]);
        println!("{name}: {said}; the constant is in its 90 % interval in {held}");
    }
}

/// Error of a logarithm, and its standard deviation.
fn error(fitted: &FittedParameter, truth: f64) -> [f64; 2] {
    [libm::log(fitted.value / truth), fitted.std / fitted.value]
}

fn summary(errors: &[[f64; 2]]) -> String {
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| -> f64 {
        errors.iter().map(of).sum::<f64>() / errors.len() as f64
    };
    let held = |error: &&[f64; 2]| error[0].abs() <= NINETY_PERCENT * error[1];
    format!(
        "90 % intervals of the logarithm hold the truth in {} of {} sets; error {:.3} in the mean, {:.3} root mean square, \
         spread {:.3} root mean square",
        errors.iter().filter(held).count(),
        errors.len(),
        mean(&|error| error[0]),
        mean(&|error| error[0] * error[0]).sqrt(),
        mean(&|error| error[1] * error[1]).sqrt()
    )
}
