//! Ablation of the robust model: whole, and with each of its ingredients left out.
//!
//! ```text
//! cargo run --release -p stickslip-experiments --bin ablation SEEDS FOLDER...
//! ```
//!
//! It runs 500 particles on all experiments in some folders (scene.toml, log.csv, truth.csv,
//! truth.json). It prints the weighted RMSE once the camera is off, and over the same rows with the
//! camera on: median and 90th percentile over the experiments of the median over seeds. It also
//! prints the coverage of 90 % intervals and the CRPS, means.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use stickslip::{Occlusion, RunOptions, quantile, run};
use stickslip_evaluation::{ScoredRun, Variant};
use stickslip_experiments::Ingredient;
use stickslip_formats::{Experiment, read_log, read_scene, read_truth_csv, read_truth_json};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let seeds: u64 = args.next().ok_or("say how many seeds")?.parse()?;
    let mut experiments = Vec::new();
    for folder in args {
        experiments.extend(read_all(Path::new(&folder))?);
    }
    if experiments.is_empty() {
        return Err("name folders of experiments".into());
    }
    println!("{} experiments, {seeds} seeds", experiments.len());
    println!(
        "{:36} {:>15} {:>6} {:>7} {:>15} {:>6}",
        "", "camera off mm", "covers", "CRPS mm", "camera on mm", "covers"
    );
    let left_out = Ingredient::ALL.into_iter().map(Some);
    for left_out in std::iter::once(None).chain(left_out) {
        let name = left_out.map_or("robust model", Ingredient::left_out);
        let dark = Scored::of(&experiments, seeds, left_out, true)?;
        let lit = Scored::of(&experiments, seeds, left_out, false)?;
        println!(
            "{name:36} {:>15} {:>5.0}% {:7.3} {:>15} {:>5.0}%",
            dark.errors(),
            1e2 * dark.held(),
            mean(&dark.crps_mm),
            lit.errors(),
            1e2 * lit.held(),
        );
    }
    Ok(())
}

/// Every experiment in a folder, in the order of their names.
fn read_all(folder: &Path) -> Result<Vec<Experiment>, Box<dyn Error>> {
    let entries: Result<Vec<_>, _> = fs::read_dir(folder)?.collect();
    let mut paths: Vec<PathBuf> = entries?.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    let logged = paths.iter().filter(|path| path.join("log.csv").is_file());
    logged.map(|path| read(path)).collect()
}

fn read(folder: &Path) -> Result<Experiment, Box<dyn Error>> {
    let text = |name: &str| {
        let path = folder.join(name);
        let text = fs::read_to_string(&path);
        text.map_err(|error| format!("{}: {error}", path.display()))
    };
    let setup = read_scene(&text("scene.toml")?, "scene.toml")?;
    let (log, _) = read_log(text("log.csv")?.as_bytes(), "log.csv")?;
    let truth = read_truth_csv(text("truth.csv")?.as_bytes(), "truth.csv")?;
    let facts = read_truth_json(&text("truth.json")?, "truth.json")?;
    Ok(Experiment::new(setup, log, Some(truth), facts)?)
}

/// Scores of experiments, a number each.
#[derive(Default)]
struct Scored {
    wmse_mm: Vec<f64>,
    held: Vec<f64>,
    crps_mm: Vec<f64>,
}

impl Scored {
    fn of(
        experiments: &[Experiment],
        seeds: u64,
        left_out: Option<Ingredient>,
        dark: bool,
    ) -> Result<Self, Box<dyn Error>> {
        let mut scored = Self::default();
        for experiment in experiments {
            let occlusion = experiment.facts.occlusion();
            let mut wmse_mm = Vec::new();
            for seed in 0..seeds {
                let mut setup = experiment.setup.clone();
                let mut options = RunOptions {
                    seed,
                    occlusion: if dark { occlusion } else { Occlusion::None },
                    ..RunOptions::default()
                };
                if let Some(ingredient) = left_out {
                    ingredient.remove_from(&mut setup, &mut options);
                }
                let run = run(&setup, &experiment.log, &options, &mut |_| ())?;
                let scored_on = (occlusion, setup.virtual_radius());
                let run = ScoredRun::of(Variant::Particle, run, experiment, scored_on);
                wmse_mm.extend(run.scores.wmse_occluded_mm);
                let belief = run.scores.belief_occluded;
                scored.held.extend(belief.covered);
                scored.crps_mm.extend(belief.crps_mm);
            }
            scored.wmse_mm.extend(quantile(&wmse_mm, 0.5));
        }
        Ok(scored)
    }

    fn errors(&self) -> String {
        let at = |share| quantile(&self.wmse_mm, share).unwrap_or(f64::NAN);
        format!("{:.3} / {:.2}", at(0.5), at(0.9))
    }

    fn held(&self) -> f64 {
        mean(&self.held)
    }
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}
