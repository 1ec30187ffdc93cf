//! `cargo bench -p stickslip-bench --bench company`: wall time and latency of a frame of the robust
//! model next to busy processes.
//!
//! It runs 500 particles over a recorded log of 600 frames, alone and next to as many busy
//! processes as there are processors. One thread and two take turns. `... -- N` takes N particles.

mod common;

use std::error::Error;
use std::io;
use std::process::{Child, Command};
use std::thread::{available_parallelism, sleep};
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};
use stickslip::{RunError, RunOptions, keep_threads_awake, quantile, run};
use stickslip_bench::Results;
use stickslip_experiments::RecordedCase;

use common::recorded_case;

/// The log.
const LOG: &str = "slide-pent-disc-104";

/// Rounds that are counted.
const ROUNDS: usize = 21;

/// Runs in a row, so that a time slice of the system is short in comparison.
const RUNS: usize = 5;

/// Time that the system has to spread the busy processes over its processors.
const SETTLING: Duration = Duration::from_millis(200);

/// Measurements on some number of threads.
#[derive(Default)]
struct Times {
    /// Mean time of a run, of each round (ms).
    runs: Vec<f64>,
    /// Times from row to row, of all rounds (ms).
    frames: Vec<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let case = recorded_case(LOG)?;
    let mut options = RunOptions::default();
    if let Some(particles) = std::env::args().find_map(|arg| arg.parse().ok()) {
        options.particles = particles;
    }

    // alone and in company in turn; one round of each is not counted
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
    let pools = [pool(1)?, pool(2)?];
    let (mut alone, mut beside) = Default::default();
    for round in 0..=ROUNDS {
        let count = round > 0;
        measure(&pools, &case, &options, count.then_some(&mut alone))?;
        let _company = Company::new()?;
        sleep(SETTLING);
        measure(&pools, &case, &options, count.then_some(&mut beside))?;
    }
    write(options.particles, &alone, &beside)
}

/// One round on each pool.
fn measure(
    pools: &[ThreadPool; 2],
    case: &RecordedCase,
    options: &RunOptions,
    times: Option<&mut [Times; 2]>,
) -> Result<(), RunError> {
    let mut measured = [const { Vec::new() }; 2];
    for (pool, frames) in pools.iter().zip(&mut measured) {
        for _ in 0..RUNS {
            frames.push(pool.install(|| keep_threads_awake(|| timed(case, options)))?);
        }
    }
    for (times, runs) in times.into_iter().flatten().zip(measured) {
        times
            .runs
            .push(runs.iter().map(|(wall, _)| wall).sum::<f64>() / RUNS as f64);
        times
            .frames
            .extend(runs.into_iter().flat_map(|(_, frames)| frames));
    }
    Ok(())
}

/// One run: wall time (ms), and the times from row to row (ms).
fn timed(case: &RecordedCase, options: &RunOptions) -> Result<(f64, Vec<f64>), RunError> {
    let start = Instant::now();
    let mut rows = Vec::with_capacity(case.log.len());
    run(&case.setup, &case.log, options, &mut |_| {
        rows.push(start.elapsed())
    })?;
    let wall = start.elapsed().as_secs_f64() * 1e3;
    let frames = rows
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).as_secs_f64() * 1e3);
    Ok((wall, frames.collect()))
}

/// Busy processes, one per processor, for as long as it lives.
struct Company(Vec<Child>);

impl Company {
    fn new() -> io::Result<Self> {
        let mut company = Company(Vec::new());
        for _ in 0..available_parallelism()?.get() {
            let endless = Command::new("sh")
                .args(["-c", "while :; do :; done"])
                .spawn()?;
            company.0.push(endless);
        }
        Ok(company)
    }
}

impl Drop for Company {
    fn drop(&mut self) {
        for process in &mut self.0 {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

fn write(particles: usize, alone: &[Times; 2], beside: &[Times; 2]) -> Result<(), Box<dyn Error>> {
    let mut results = Results::open()?;
    let median = |times: &Times| quantile(&times.runs, 0.5).unwrap_or(f64::NAN);
    for (situation, times) in [("alone", alone), ("beside", beside)] {
        for (threads, times) in ["1 thread", "2 threads"].into_iter().zip(times) {
            let name = format!("company / {particles} / {situation} / {threads}");
            results.write(&format!("{name} / wall"), median(times), "ms")?;
            for (what, p) in [
                ("median", 0.5),
                ("99.9th percentile", 0.999),
                ("slowest", 1.0),
            ] {
                let frame = quantile(&times.frames, p);
                results.write(&format!("{name} / frame; {what}"), frame, "ms")?;
            }
        }
    }
    let ratios = [
        ("alone / 1 thread over 2", &alone[0], &alone[1]),
        ("beside / 1 thread over 2", &beside[0], &beside[1]),
        ("1 thread / beside over alone", &beside[0], &alone[0]),
        ("2 threads / beside over alone", &beside[1], &alone[1]),
    ];
    for (what, over, under) in ratios {
        let name = format!("company / {particles} / {what}");
        results.write(&name, median(over) / median(under), "1")?;
    }
    Ok(())
}
