//! Results of fits on random virtual rigs whose constants are known, a line for each, and coverage
//! of the 90 % intervals of the constants:
//! `cargo run --release -p stickslip-fit --example rigs -- face 0 60`.
//!
//! The first word is the support of the rigs: `tripod` (the model's own physics), `face` or `feet`
//! (the testbed's). Numbers are the first rig and how many.
//!
//! The numbers of `crates/fit/src/discrepancy.rs` are those with which the even rigs of 0 to 59 of
//! each kind were most likely. The odd ones judged them, then rigs from 100 on, which nothing was
//! chosen by.

mod random_rig;

use random_rig::{RandomRig, Support};
use stickslip_fit::{Fit, FitOptions, FittedParameter, Parameter, fit};

/// Numbers of pushes, rig by rig.
const PUSHES: [usize; 4] = [4, 6, 8, 12];

/// Comparison of a fitted value and its constant with the truth, in logarithms.
struct Outcome {
    error: f64,
    spread: f64,
    std_ratio: f64,
    constant_error: f64,
    /// Half the width of the constant's interval.
    half_width: f64,
    held: bool,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let support = match arguments.next().as_deref() {
        Some("tripod") => Support::Tripod,
        Some("feet") => Support::ThreeFeet,
        _ => Support::Face,
    };
    let mut number = |default| {
        arguments
            .next()
            .and_then(|n| n.parse().ok())
            .unwrap_or(default)
    };
    let (first, count): (u64, u64) = (number(0), number(60));
    let options = FitOptions {
        parameters: vec![Parameter::MuP, Parameter::TripodRadius],
        seed: 0,
    };
    let mut outcomes: [Vec<Outcome>; 2] = Default::default();
    println!(
        "rig pushes drift, then of mu_p and tripod_radius: error spread spread/prior of the value, error half-width of the constant"
    );
    for seed in first..first + count {
        let rig = RandomRig::new(support, seed, PUSHES[seed as usize % PUSHES.len()]);
        let fit = fit(&rig.pushes, &options, &|_, _| ()).expect("a fit");
        let of_rig = compared(&fit, [rig.mu_p, rig.d_tri]);
        println!(
            "{seed} {} {:.5} {}",
            fit.pushes,
            fit.noise.drift,
            of_rig.each_ref().map(line).join(" ")
        );
        for (all, one) in outcomes.iter_mut().zip(of_rig) {
            all.push(one);
        }
    }
    for (name, outcomes) in ["mu_p", "tripod_radius"].into_iter().zip(&outcomes) {
        println!("{name}: {}", summary(outcomes));
    }
}

fn compared(fit: &Fit, truths: [f64; 2]) -> [Outcome; 2] {
    std::array::from_fn(|k| {
        let (truth, fitted): (f64, &FittedParameter) = (truths[k], &fit.parameters[k]);
        let constant = fitted.constant.expect("a constant");
        Outcome {
            error: libm::log(fitted.value / truth),
            spread: fitted.std / fitted.value,
            std_ratio: fitted.std_ratio,
            constant_error: libm::log(constant.value / truth),
            half_width: 0.5 * libm::log(constant.high_90 / constant.low_90),
            held: (constant.low_90..=constant.high_90).contains(&truth),
        }
    })
}

fn line(of: &Outcome) -> String {
    format!(
        "{:.4} {:.4} {:.3} {:.4} {:.4}",
        of.error, of.spread, of.std_ratio, of.constant_error, of.half_width
    )
}

fn summary(outcomes: &[Outcome]) -> String {
    let rms = |of: &dyn Fn(&Outcome) -> f64| {
        let squares: f64 = outcomes
            .iter()
            .map(|outcome| of(outcome) * of(outcome))
            .sum();
        (squares / outcomes.len() as f64).sqrt()
    };
    format!(
        "90 % intervals of the constant hold the truth on {} of {} rigs; root mean squares: error of the value {:.3}, its spread {:.3}, \
         error of the constant {:.3}, half-width of its interval {:.3}",
        outcomes.iter().filter(|outcome| outcome.held).count(),
        outcomes.len(),
        rms(&|outcome| outcome.error),
        rms(&|outcome| outcome.spread),
        rms(&|outcome| outcome.constant_error),
        rms(&|outcome| outcome.half_width)
    )
}
