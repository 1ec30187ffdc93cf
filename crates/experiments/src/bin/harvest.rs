//! `cargo run --release -p stickslip-experiments --bin harvest [-- DIR...]`: the particle filter
//! over every recorded experiment, by default all of `STICKSLIP_DATA`, with every step judged by
//! the independent residual; then a sample of the steps as hard problems of their own. Exits with 1
//! where a step failed, a residual exceeds 1e-9 m/s, or a proof of infeasibility contradicts a
//! known solution.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use rayon::prelude::*;
use stickslip::Occlusion;
use stickslip_experiments::{
    Harvest, HarvestOptions, RecordedCase, harvest, recorded_cases, survey_steps,
};
use stickslip_testkit::{Tally, data_root};

const OPTIONS: HarvestOptions = HarvestOptions {
    particles: 32,
    keep_one_in: 40,
};

/// Experiments that are run before their rows are printed.
const BATCH: usize = 16;

/// Seed of the disturbances.
const SEED: u64 = 1;

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> ExitCode {
    let given: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let roots = if given.is_empty() {
        data_root().into_iter().collect()
    } else {
        given
    };
    match harvest_all(&roots, &mut io::stdout().lock()) {
        Ok(sound) => ExitCode::from(u8::from(!sound)),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(1)
        }
    }
}

/// Harvests all recorded cases. Returns true if every step was solved or proven to have no
/// solution.
fn harvest_all(roots: &[PathBuf], out: &mut impl Write) -> Result<bool, Failure> {
    if roots.is_empty() {
        return Err("no recorded data; give folders, or set STICKSLIP_DATA".into());
    }
    let mut all = Harvest::default();
    writeln!(out, "{:<78} {}", "experiment", Tally::TITLES)?;
    for root in roots {
        for batch in recorded_cases(root)?.chunks(BATCH) {
            let harvests: Vec<_> = batch
                .par_iter()
                .map(|case| harvest(case, &OPTIONS))
                .collect();
            for (case, harvest) in batch.iter().zip(harvests) {
                let harvest =
                    harvest.map_err(|error| format!("{}: {error}", case.folder.display()))?;
                writeln!(out, "{:<78} {}", name(case), harvest.tally)?;
                all.tally.add(harvest.tally);
                all.kept.extend(harvest.kept);
                all.refuted.extend(harvest.refuted);
            }
        }
    }
    writeln!(out, "{:<78} {}", "all", all.tally)?;
    for problem in all.refuted.iter().take(3) {
        writeln!(out, "not solved: {problem:?}")?;
    }
    let sound = survey(&all, out)?;
    Ok(sound && all.refuted.is_empty())
}

/// The harvested steps as problems of their own.
fn survey(all: &Harvest, out: &mut impl Write) -> io::Result<bool> {
    let mut sound = true;
    writeln!(out, "\n{:<78} {}", "from a cold start", Tally::TITLES)?;
    for (name, tally) in survey_steps(&all.kept, SEED) {
        writeln!(out, "{name:<78} {tally}")?;
        sound &= tally.failed.is_empty() && tally.contradicted.is_empty();
        for (what, indices) in [
            ("failed", &tally.failed),
            ("infeasible against a known solution", &tally.contradicted),
        ] {
            if !indices.is_empty() {
                writeln!(out, "{what}: {:?}", &indices[..indices.len().min(20)])?;
            }
        }
    }
    Ok(sound)
}

/// The experiment's last two folders, its scene where that is not the usual one, and the hidden
/// rows.
fn name(case: &RecordedCase) -> String {
    let parts: Vec<_> = case
        .folder
        .iter()
        .rev()
        .take(2)
        .map(|part| part.to_string_lossy())
        .collect();
    let scene = case
        .scene_name
        .strip_suffix(".toml")
        .filter(|scene| *scene != "scene")
        .unwrap_or_default();
    let hidden = match case.occlusion {
        Occlusion::None => String::new(),
        Occlusion::Rows { from, .. } => format!("hidden from {from}"),
        Occlusion::Middle { seconds } => format!("hidden {seconds} s"),
    };
    [
        parts.into_iter().rev().collect::<Vec<_>>().join("/"),
        scene.to_owned(),
        hidden,
    ]
    .join(" ")
    .trim_end()
    .to_owned()
}
