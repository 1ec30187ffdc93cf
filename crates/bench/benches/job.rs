//! `cargo bench -p stickslip-bench --bench job`: wall time and latency of a frame for the paper's
//! job.
//!
//! It runs 500 particles over a recorded log of 600 frames, camera and touch sensors weighing
//! throughout, with both models, on one thread and on two. `... -- NAME` runs that log only.

use std::error::Error;
use std::time::Instant;

use stickslip::{FilterModel, Occlusion, RunOptions, keep_threads_awake, quantile, run};
use stickslip_bench::Results;
use stickslip_experiments::{RecordedCase, recorded_cases};
use stickslip_testkit::data_root;

/// Rounds that are counted.
const ROUNDS: usize = 21;

/// The logs.
const LOGS: [&str; 3] = [
    "slide-pent-disc-104",
    "slide-ell-bar-117",
    "slide-trapezoid-disc-109",
];

fn main() -> Result<(), Box<dyn Error>> {
    let root = data_root().ok_or("no recorded experiments: point STICKSLIP_DATA at them")?;
    let mut results = Results::open()?;
    let named = |log: &str| {
        std::env::args()
            .skip(1)
            .all(|arg| arg.starts_with('-') || arg == log)
    };
    for log in LOGS.into_iter().filter(|log| named(log)) {
        let cases = recorded_cases(&root.join("mujoco").join(log))?;
        let case = cases
            .iter()
            .find(|case| case.occlusion == Occlusion::None)
            .ok_or("no case without an occlusion")?;
        for (model, rules) in [
            (FilterModel::Paper, "paper"),
            (FilterModel::Robust, "robust"),
        ] {
            let options = RunOptions {
                model,
                ..RunOptions::default()
            };
            write(&format!("{rules} / {log}"), case, &options, &mut results)?;
        }
    }
    Ok(())
}

/// Both numbers of threads in turn, one round of each that is not counted.
fn write(
    name: &str,
    case: &RecordedCase,
    options: &RunOptions,
    results: &mut Results,
) -> Result<(), Box<dyn Error>> {
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let mut walls = [const { Vec::new() }; 2];
    let mut latencies = [const { Vec::new() }; 2];
    for round in 0..=ROUNDS {
        for (k, pool) in pools.iter().enumerate() {
            let pool = pool.as_ref().map_err(ToString::to_string)?;
            let (wall, frames) = pool.install(|| keep_threads_awake(|| timed(case, options)))?;
            if round > 0 {
                walls[k].push(wall);
                latencies[k].extend(frames);
            }
        }
    }
    for (k, threads) in ["1 thread", "2 threads"].into_iter().enumerate() {
        let name = format!("job / {name} / {threads}");
        results.write(&format!("{name} / wall"), quantile(&walls[k], 0.5), "ms")?;
        results.write(
            &format!("{name} / frame; median"),
            quantile(&latencies[k], 0.5),
            "ms",
        )?;
        results.write(
            &format!("{name} / frame; 99.9th percentile"),
            quantile(&latencies[k], 0.999),
            "ms",
        )?;
        results.write(
            &format!("{name} / frame; slowest"),
            quantile(&latencies[k], 1.0),
            "ms",
        )?;
    }
    let [one, two] = walls.each_ref().map(|wall| quantile(wall, 0.5));
    results.write(
        &format!("job / {name} / 1 thread over 2"),
        one.zip(two).map(|(one, two)| one / two),
        "1",
    )?;
    Ok(())
}

/// One run: wall time (ms), and the time from row to row (ms).
fn timed(
    case: &RecordedCase,
    options: &RunOptions,
) -> Result<(f64, Vec<f64>), stickslip::RunError> {
    let start = Instant::now();
    let mut rows = Vec::with_capacity(case.log.len());
    let run = run(&case.setup, &case.log, options, &mut |_| {
        rows.push(start.elapsed())
    });
    let wall = start.elapsed();
    run?;
    let frames = rows
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).as_secs_f64() * 1e3);
    Ok((wall.as_secs_f64() * 1e3, frames.collect()))
}
