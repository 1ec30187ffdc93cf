//! `cargo run --release -p stickslip-evaluation --bin calibration [RUNS [PARTICLES]] [KEY=VALUE]...`: where
//! the truth lies in the filter's belief, over experiments whose friction is drawn from the prior: moved by
//! the filter's own noisy dynamics, by these without noise and by the testbed, with touch, without, and with the
//! camera on throughout, in both modes. "last seen" is the coverage when the camera goes dark, in all runs. Keys are those of a
//! scene's `[uncertainty]`, of truths as of the filter: `latency=0 outline=0` is what they cost. With keys
//! only contact mode, which knows them, is run.

use std::error::Error;

use stickslip::{Mode, Uncertainty};
use stickslip_evaluation::paper::PaperExperiment;
use stickslip_evaluation::{
    CalibrationOptions, CalibrationRun, Physics, QUANTITIES, Tally, TruthSource, Variant,
};
use stickslip_formats::read_scene;

/// With what names they are shown.
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
        true => &[(Mode::Contact, "contact"), (Mode::Paper, "paper")][..],
        false => &[(Mode::Contact, "contact")],
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
        for &(mode, name) in modes {
            for (variant, sensors) in VARIANTS {
                let options = CalibrationOptions {
                    source,
                    mode,
                    uncertainty,
                    variant,
                    particles,
                };
                println!("\n{truth}: {name} mode, {sensors}");
                show(&CalibrationRun::of_papers(runs, &options));
            }
        }
    }
    Ok(())
}

/// What `keys` say, read as a scene file's; the rest by default.
fn uncertainty(keys: &[&String]) -> Result<Uncertainty, Box<dyn Error>> {
    let lines: Vec<String> = keys.iter().map(|key| key.replacen('=', " = ", 1)).collect();
    let scene = PaperExperiment::A.scene().scene;
    let text = format!("{scene}\n[uncertainty]\n{}\n", lines.join("\n"));
    Ok(read_scene(&text, "the given keys")?.uncertainty)
}

fn show(runs: &[CalibrationRun]) {
    println!(
        "  quantity  runs  coverage      chi2 of ranks   median error   of the prior   last seen"
    );
    for (which, name) in QUANTITIES.iter().enumerate() {
        match Tally::of(runs, which) {
            None => println!("  {name:<8}  not observed"),
            Some(tally) => println!(
                "  {name:<8} {:5}  {:.2} +- {:.2} {:12.1} {:15.3e} {:14.3e} {:11.2}",
                tally.runs,
                tally.covered,
                tally.standard_error,
                tally.chi_squared,
                tally.error,
                tally.prior_error,
                tally.covered_seen
            ),
        }
    }
}
