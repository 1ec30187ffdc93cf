//! `cargo run --release -p stickslip-experiments --bin reference [PARTICLES [MANY [SEEDS]]]`:
//! agreement of 500 particles with a million on the same data.
//!
//! It runs the paper's experiments as the testbed simulates them, with touch, while the camera is
//! off. Where the reference is as wrong, the error is owed to the model; where it is better, to the
//! number of particles. A million particles take five gigabytes.

use std::error::Error;

use stickslip_evaluation::paper::{PaperExperiment, Replicate};
use stickslip_experiments::Agreement;

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Result<Vec<usize>, _> = std::env::args().skip(1).map(|n| n.parse()).collect();
    let numbers = numbers?;
    let number = |place: usize, default: usize| numbers.get(place).copied().unwrap_or(default);
    let (few, many, seeds) = (number(0, 500), number(1, 1_000_000), number(2, 1));
    println!(
        "{few} particles that move, {many} that are weighed alone; occluded rows, touch, robust model"
    );
    println!(
        "experiment seed   RMSE mm: few, many   CRPS mm: few, many   covers: few, many   distance   spread"
    );
    for paper in PaperExperiment::ALL {
        for seed in 0..seeds as u64 {
            let agreement = Agreement::of(&Replicate::simulate(paper, seed)?, few, many)?;
            show(paper, seed, &agreement);
        }
    }
    Ok(())
}

fn show(paper: PaperExperiment, seed: u64, agreement: &Agreement) {
    let Agreement {
        few,
        reference,
        distance,
        spread,
    } = agreement;
    let pair = |few: Option<f64>, many: Option<f64>, digits: usize| {
        let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.digits$}"));
        format!("{:>8} {:>8}", cell(few), cell(many))
    };
    println!(
        "{:<10} {seed:4} {} {} {} {distance:10.2} {spread:8.2}",
        paper.name(),
        pair(few.wmse_occluded_mm, reference.wmse_occluded_mm, 3),
        pair(
            few.belief_occluded.crps_mm,
            reference.belief_occluded.crps_mm,
            3
        ),
        pair(
            few.belief_occluded.covered,
            reference.belief_occluded.covered,
            2
        ),
    );
}
