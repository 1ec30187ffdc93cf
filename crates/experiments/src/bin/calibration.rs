//! Coverage of the filter's 90 % intervals over experiments whose friction is drawn from the prior:
//!
//! ```text
//! cargo run --release -p stickslip-experiments --bin calibration [RUNS [PARTICLES]] [KEY=VALUE]...
//! ```
//!
//! The object is moved by the filter's own noisy dynamics, by these without noise, and by the
//! testbed. Runs are with touch, without touch, and with touch and the camera on throughout, with
//! both models. The truth's place in the belief is taken at the end in the runs that identify a
//! quantity, and in all runs at the last row that the camera saw.
//!
//! Keys are those of a scene's `[uncertainty]`, of truths as of the filter. `latency=0` shows
//! its cost. With keys, only the robust model is run, since only it has them.

use std::error::Error;

use stickslip::{FilterModel, Uncertainty};
use stickslip_evaluation::paper::PaperExperiment;
use stickslip_evaluation::{Physics, Variant};
use stickslip_experiments::{
    CalibrationOptions, CalibrationRun, Observed, QUANTITIES, RankTally, Tally, TruthSource,
};
use stickslip_formats::read_scene;

/// Variants, with the names by which they are shown.
const VARIANTS: [(Variant, &str); 3] = [
    (Variant::Particle, "touch"),
    (Variant::ParticleNoTouch, "no touch"),
    (Variant::ParticleCameraOn, "touch, camera on"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let (keys, numbers): (Vec<_>, Vec<_>) = given.iter().partition(|word| word.contains('='));
    let numbers: Result<Vec<usize>, _> = numbers.iter().map(|n| n.parse()).collect();
    let numbers = numbers?;
    let runs = numbers.first().copied().unwrap_or(200);
    let particles = numbers.get(1).copied().unwrap_or(500);
    let uncertainty = uncertainty(&keys)?;
    let modes = match keys.is_empty() {
        true => &[
            (FilterModel::Robust, "robust"),
            (FilterModel::Paper, "paper"),
        ][..],
        false => &[(FilterModel::Robust, "robust")],
    };
    println!(
        "{runs} runs each, {particles} particles; coverage of 90 % intervals at the end of the run"
    );
    let sources = [
        (TruthSource::Prior, "filter's own physics, noise included"),
        (
            TruthSource::Simulated(Physics::Model),
            "its dynamics without noise",
        ),
        (TruthSource::Simulated(Physics::Testbed), "testbed"),
    ];
    for (source, truth) in sources {
        for &(model, name) in modes {
            for (variant, sensors) in VARIANTS {
                let options = CalibrationOptions {
                    source,
                    model,
                    uncertainty,
                    variant,
                    particles,
                };
                println!("\n{truth}: {name} model, {sensors}");
                show(&CalibrationRun::of_papers(runs, &options));
            }
        }
    }
    Ok(())
}

/// Uncertainty by `keys`, read as those of a scene file; the rest by default.
fn uncertainty(keys: &[&String]) -> Result<Uncertainty, Box<dyn Error>> {
    let lines: Vec<String> = keys.iter().map(|key| key.replacen('=', " = ", 1)).collect();
    let scene = PaperExperiment::A.scene().scene;
    let text = format!("{scene}\n[uncertainty]\n{}\n", lines.join("\n"));
    Ok(read_scene(&text, "the given keys")?.uncertainty)
}

fn show(runs: &[CalibrationRun]) {
    let ranks = |of: &str| format!("{of:>13}  {:<14} {:>6}", "coverage", "chi2");
    let errors = format!("{:>14} {:>13}", "median error", "of the prior");
    println!(
        "  quantity {} {errors}    {}",
        ranks("observed"),
        ranks("last seen")
    );
    for (which, name) in QUANTITIES.iter().enumerate() {
        let Some(tally) = Tally::of(runs, which) else {
            println!("  {name:<8}  no runs");
            continue;
        };
        let observed = match tally.observed {
            None => format!("{:13} {:51}", 0, ""),
            Some(Observed {
                ranks,
                error,
                prior_error,
            }) => format!("{} {error:14.3e} {prior_error:13.3e}", columns(&ranks)),
        };
        println!("  {name:<8} {observed}    {}", columns(&tally.seen));
    }
}

fn columns(ranks: &RankTally) -> String {
    let RankTally {
        count,
        covered,
        standard_error,
        chi_squared,
    } = ranks;
    format!("{count:13}  {covered:.3} +- {standard_error:.3} {chi_squared:6.1}")
}
