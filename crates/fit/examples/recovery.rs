//! How often 90 % intervals of learnt friction hold the truth, over sets of simulated pushes whose friction
//! is drawn from the prior: `cargo run --release -p stickslip-fit --example recovery -- 30 model`.
#![allow(
    clippy::unwrap_used,
    reason = "a simulated set that cannot be made ends it"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{pushes, rig_tripod_radius, setup};
use stickslip_evaluation::Physics;
use stickslip_filter::Streams;
use stickslip_fit::{FitOptions, FittedParameter, Parameter, fit};

/// Pushes of a set.
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
    let options = FitOptions {
        parameters: vec![Parameter::MuP, Parameter::TripodRadius],
        seed: 0,
    };
    let mut held = [0_u32; 2];
    for set in 0..sets {
        let truth = setup().drawn_friction(Streams::new(1000 + set).normals(0, 0, 0));
        let seed = 100 * set;
        let fit = fit(&pushes(truth, physics, PUSHES, seed), &options).expect("a fit");
        let d_tri = match physics {
            Physics::Model => truth.d_tri,
            Physics::Testbed => rig_tripod_radius(truth, seed),
        };
        for (k, truth) in [truth.mu_p, d_tri].into_iter().enumerate() {
            held[k] += u32::from(holds(&fit.parameters[k], truth));
        }
    }
    println!(
        "90 % intervals hold the truth in {sets} sets: mu_p {}, tripod_radius {}",
        held[0], held[1]
    );
}

/// Whether the 90 % interval of a logarithm holds that of the truth.
fn holds(fitted: &FittedParameter, truth: f64) -> bool {
    let off = libm::log(fitted.value / truth).abs();
    off <= NINETY_PERCENT * fitted.std / fitted.value
}
