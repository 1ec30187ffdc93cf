//! Results of fits on random virtual rigs whose constants are known, a line for each, and coverage
//! of the 90 % intervals of the constants:
//! `cargo run --release -p stickslip-fit --example rigs -- face 0 60`.
//!
//! The first word is the support of the rigs: `tripod` (the model's own physics), `prior` (the same
//! with feet that the fit's prior draws), `face` or `feet` (the testbed's). Numbers are the first
//! rig and how many.
//!
//! Free is what is free by default: μ_p and the support.

mod random_rig;

use random_rig::{RandomRig, Support};
use stickslip_fit::{Fit, FitOptions, FittedParameter, Parameter, fit};

/// Numbers of pushes, rig by rig.
const PUSHES: [usize; 4] = [4, 6, 8, 12];

/// Comparison of a fitted value and its constant with the truth, in whitened coordinates.
struct Outcome {
    name: &'static str,
    error: f64,
    spread: f64,
    held: bool,
    /// Share of the posterior's draws below the truth.
    rank: f64,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let support = match arguments.next().as_deref() {
        Some("tripod") => Support::Tripod,
        Some("prior") => Support::Prior,
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
    let mut outcomes: Vec<Vec<Outcome>> = Vec::new();
    println!("rig pushes drift R-hat, then of each parameter, over its prior: error spread held");
    for seed in first..first + count {
        let rig = RandomRig::new(support, seed, PUSHES[seed as usize % PUSHES.len()]);
        let options = FitOptions {
            parameters: Parameter::default_list(&rig.pushes[0].setup),
            seed: 0,
        };
        let fit = fit(&rig.pushes, &options, &|_, _| ()).expect("a fit");
        let of_rig = compared(&fit, &rig.truth);
        println!(
            "{seed} {} {:.5} {:.3} {}",
            fit.pushes,
            fit.noise.drift,
            fit.sampling.split_rhat,
            of_rig.iter().map(line).collect::<Vec<_>>().join(" ")
        );
        outcomes.resize_with(of_rig.len(), Vec::new);
        for (all, one) in outcomes.iter_mut().zip(of_rig) {
            all.push(one);
        }
    }
    for outcomes in &outcomes {
        println!("{}", summary(outcomes));
    }
}

fn compared(fit: &Fit, truths: &[f64]) -> Vec<Outcome> {
    let draws = fit.draws();
    let of_parameters = truths.iter().zip(&fit.parameters).zip(&draws);
    let compared = |((truth, fitted), (_, draws)): ((&f64, &FittedParameter), &(_, Vec<f64>))| {
        let below = draws.iter().filter(|draw| *draw < truth).count();
        let [low, high] = fitted.interval_90;
        let coordinate = |value| fitted.prior.coordinate(value);
        Outcome {
            name: fitted.name(),
            error: coordinate(fitted.value) - coordinate(*truth),
            spread: fitted.std_ratio,
            held: (low..=high).contains(truth),
            rank: below as f64 / draws.len() as f64,
        }
    };
    of_parameters.map(compared).collect()
}

fn line(of: &Outcome) -> String {
    format!("{:.3} {:.3} {}", of.error, of.spread, of.held)
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
        "{}: 90 % intervals hold the truth on {} of {} rigs; over the prior's standard deviation: mean error {:.3}, root mean squares of error {:.3} and spread {:.3}; ranks of the truth by fifths {:?}",
        outcomes[0].name,
        outcomes.iter().filter(|outcome| outcome.held).count(),
        outcomes.len(),
        outcomes.iter().map(|outcome| outcome.error).sum::<f64>() / outcomes.len() as f64,
        rms(&|outcome| outcome.error),
        rms(&|outcome| outcome.spread),
        fifths
    )
}
