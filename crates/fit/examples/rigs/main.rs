//! Results of fits on random virtual rigs whose constants are known, a line for each, and coverage
//! of the 90 % intervals of the constants:
//! `cargo run --release -p stickslip-fit --example rigs -- face 0 60`.
//!
//! The first word is the support of the rigs: `tripod` (the model's own physics), `face` or `feet`
//! (the testbed's). Numbers are the first rig and how many.
//!
//! Free is what is free by default: μ_p and the support.

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
    /// Half the width of its 90 % interval.
    half_width: f64,
    held: bool,
    /// Share of the posterior's draws below the truth.
    rank: f64,
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
    let mut outcomes: [Vec<Outcome>; 2] = Default::default();
    println!(
        "rig pushes drift R-hat, then of mu_p and tripod_radius: error spread spread/prior half-width held"
    );
    for seed in first..first + count {
        let rig = RandomRig::new(support, seed, PUSHES[seed as usize % PUSHES.len()]);
        let options = FitOptions {
            parameters: Parameter::default_list(&rig.pushes[0].setup),
            seed: 0,
        };
        let fit = fit(&rig.pushes, &options, &|_, _| ()).expect("a fit");
        let of_rig = compared(&fit, [rig.mu_p, rig.d_tri]);
        println!(
            "{seed} {} {:.5} {:.3} {}",
            fit.pushes,
            fit.noise.drift,
            fit.sampling.split_rhat,
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
        let (_, draws) = &fit.draws()[k];
        let below = draws.iter().filter(|draw| **draw < truth).count();
        let [low, high] = fitted.interval_90;
        Outcome {
            error: libm::log(fitted.value / truth),
            spread: fitted.std / fitted.value,
            std_ratio: fitted.std_ratio,
            half_width: 0.5 * libm::log(high / low),
            held: (low..=high).contains(&truth),
            rank: below as f64 / draws.len() as f64,
        }
    })
}

fn line(of: &Outcome) -> String {
    format!(
        "{:.4} {:.4} {:.3} {:.4} {}",
        of.error, of.spread, of.std_ratio, of.half_width, of.held
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
    let mut fifths = [0; 5];
    for outcome in outcomes {
        fifths[((5.0 * outcome.rank) as usize).min(4)] += 1;
    }
    format!(
        "90 % intervals hold the truth on {} of {} rigs; root mean squares: error {:.3}, spread {:.3}, half-width of the interval {:.3}; ranks of the truth by fifths {:?}",
        outcomes.iter().filter(|outcome| outcome.held).count(),
        outcomes.len(),
        rms(&|outcome| outcome.error),
        rms(&|outcome| outcome.spread),
        rms(&|outcome| outcome.half_width),
        fifths
    )
}
