//! `cargo run --release -p stickslip-evaluation --bin calibration [RUNS [PARTICLES]]`: where the truth
//! lies in the filter's belief, over simulated experiments whose friction is drawn from the prior, in
//! the filter's own physics and in the testbed's, with touch and without, in both modes.

use stickslip::Mode;
use stickslip_evaluation::paper::PaperExperiment;
use stickslip_evaluation::{CalibrationOptions, CalibrationRun, Physics, QUANTITIES, Tally};

fn main() -> Result<(), std::num::ParseIntError> {
    let numbers: Result<Vec<usize>, _> = std::env::args().skip(1).map(|n| n.parse()).collect();
    let numbers = numbers?;
    let runs = numbers.first().copied().unwrap_or(200);
    let particles = numbers.get(1).copied().unwrap_or(500);
    println!(
        "{runs} runs each, {particles} particles; coverage of 90 % intervals at the end of the run"
    );
    for physics in [Physics::Model, Physics::Testbed] {
        for (mode, name) in [(Mode::Contact, "contact"), (Mode::Paper, "paper")] {
            for touch in [true, false] {
                let options = CalibrationOptions {
                    physics,
                    mode,
                    touch,
                    particles,
                };
                let sensors = if touch { "touch" } else { "no touch" };
                println!("\n{} physics, {name} mode, {sensors}", physics.name());
                show(&simulate(runs, &options));
            }
        }
    }
    Ok(())
}

/// The paper's experiments in turn.
fn simulate(runs: usize, options: &CalibrationOptions) -> Vec<CalibrationRun> {
    let papers = PaperExperiment::ALL.into_iter().cycle();
    let seeded = papers.zip(0..runs as u64);
    seeded
        .filter_map(|(paper, seed)| CalibrationRun::new(paper, seed, options))
        .collect()
}

fn show(runs: &[CalibrationRun]) {
    println!("  quantity  runs  coverage      chi2 of ranks   median error   of the prior");
    for (which, name) in QUANTITIES.iter().enumerate() {
        match Tally::of(runs, which) {
            None => println!("  {name:<8}  not observed"),
            Some(tally) => println!(
                "  {name:<8} {:5}  {:.2} +- {:.2} {:12.1} {:15.3e} {:14.3e}",
                tally.runs,
                tally.covered,
                tally.standard_error,
                tally.chi_squared,
                tally.error,
                tally.prior_error
            ),
        }
    }
}
