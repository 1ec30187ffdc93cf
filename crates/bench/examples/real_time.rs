//! `cargo run --release -p stickslip-bench --example real_time SEEDS FOLDER...`: real-time factors
//! of whole runs, and whether one is much slower than the others.
//!
//! It runs both models on all experiments below some folders, with the camera off and on, 500
//! particles, one run after the other.
//!
//! A run's real-time factor is the length of the log over the time that its estimate takes, files
//! not included. A log's time is that of the median of its seeds, for each second of the log.

use std::error::Error;
use std::num::NonZero;
use std::path::Path;
use std::thread::available_parallelism;
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use stickslip::{
    FilterModel, Occlusion, RunOptions, keep_threads_awake, quantile, run, useful_threads,
};
use stickslip_experiments::{RecordedCase, recorded_cases};

/// Cost of a run of one experiment.
struct Timed {
    name: String,
    real_time_factor: f64,
    /// Particle-steps without a certified solution; of those, the ones whose solver gave up.
    unsolved: u64,
    failed: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let seeds: u64 = args.next().ok_or("say how many seeds")?.parse()?;
    let mut cases = Vec::new();
    for folder in args {
        cases.extend(recorded_cases(Path::new(&folder))?);
    }
    if cases.is_empty() || seeds == 0 {
        return Err("name folders of experiments, and at least one seed".into());
    }
    let useful = useful_threads(RunOptions::default().particles);
    let threads = available_parallelism().map_or(1, NonZero::get).min(useful);
    println!(
        "{seeds} seeds, {threads} threads; log: time of the slowest log over the median log's"
    );
    println!(
        "{:18} {:>5} {:>8} {:>8} {:>6} {:>6} {:>6} {:>9} {:>7}  slowest run",
        "", "runs", "median x", "slowest", "log", "< 100", "< 20", "unsolved", "failed"
    );
    let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
    for (model, rules) in [
        (FilterModel::Paper, "paper"),
        (FilterModel::Robust, "robust"),
    ] {
        for (dark, camera) in [(true, "dark"), (false, "camera on")] {
            let cases = cases
                .iter()
                .filter(|case| dark == (case.occlusion != Occlusion::None));
            let logs = pool.install(|| {
                cases
                    .map(|case| timed_runs(case, model, seeds))
                    .collect::<Result<Vec<_>, _>>()
            })?;
            println!("{:18} {}", format!("{rules}, {camera}"), summary(&logs));
        }
    }
    Ok(())
}

/// A run of each seed.
fn timed_runs(
    case: &RecordedCase,
    model: FilterModel,
    seeds: u64,
) -> Result<Vec<Timed>, stickslip::RunError> {
    let folder = case.folder.file_name().unwrap_or_default();
    (0..seeds)
        .map(|seed| {
            let options = RunOptions {
                model,
                seed,
                occlusion: case.occlusion,
                ..RunOptions::default()
            };
            let start = Instant::now();
            let run = keep_threads_awake(|| run(&case.setup, &case.log, &options, &mut |_| ()))?;
            Ok(Timed {
                name: format!("{}, seed {seed}", folder.to_string_lossy()),
                real_time_factor: case.log.duration() / start.elapsed().as_secs_f64(),
                unsolved: run.unsolved,
                failed: run.failed,
            })
        })
        .collect()
}

/// The columns after the name, of the runs of each log.
fn summary(logs: &[Vec<Timed>]) -> String {
    let runs: Vec<&Timed> = logs.iter().flatten().collect();
    let factors: Vec<f64> = runs.iter().map(|run| run.real_time_factor).collect();
    let times: Vec<f64> = logs
        .iter()
        .filter_map(|runs| {
            let times: Vec<f64> = runs.iter().map(|run| 1.0 / run.real_time_factor).collect();
            quantile(&times, 0.5)
        })
        .collect();
    let at = |of: &[f64], share| quantile(of, share).unwrap_or(f64::NAN);
    let below = |limit| factors.iter().filter(|&&factor| factor < limit).count();
    let slowest = runs
        .iter()
        .min_by(|a, b| a.real_time_factor.total_cmp(&b.real_time_factor));
    format!(
        "{:5} {:8.0} {:8.1} {:6.2} {:6} {:6} {:9} {:7}  {}",
        runs.len(),
        at(&factors, 0.5),
        at(&factors, 0.0),
        at(&times, 1.0) / at(&times, 0.5),
        below(100.0),
        below(20.0),
        runs.iter().map(|run| run.unsolved).sum::<u64>(),
        runs.iter().map(|run| run.failed).sum::<u64>(),
        slowest.map_or("", |run| &run.name),
    )
}
