//! `cargo bench -p stickslip-bench --bench particles`: the whole filter step from 100 particles to
//! 250,000, on one thread and on two; `... -- --million` goes on to 1,000,000. The frames are those
//! of a recorded log around its first contacts.

mod common;

use std::error::Error;
use std::time::Instant;

use stickslip::{FilterModel, Log, RunOptions, Setup, keep_threads_awake, run};
use stickslip_bench::Results;

use common::recorded_case;

/// The log, and the rows of it that are run: the pusher arrives at row 71, the first fixel touches
/// at row 165.
const LOG: &str = "slide-pent-disc-104";
const ROWS: std::ops::Range<usize> = 60..200;

/// Rows at the start that are not counted.
const WARM_UP: usize = 20;

/// Particle-frames that a measurement is made of, at least.
const LEAST_WORK: usize = 2_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let case = recorded_case(LOG)?;
    let log = part(&case.log);
    let mut counts = vec![100, 500, 1_000, 10_000, 100_000, 250_000];
    counts.extend(
        std::env::args()
            .any(|a| a == "--million")
            .then_some(1_000_000),
    );
    let mut results = Results::open()?;
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        for &particles in &counts {
            let time =
                pool.install(|| keep_threads_awake(|| frame_time(&case.setup, &log, particles)))?;
            let name = format!("particles / {threads} threads / {particles}");
            results.write(&name, time * 1e9 / particles as f64, "ns/particle-frame")?;
            results.write(&format!("{name} / frames"), 1.0 / time, "1/s")?;
            results.write(
                &format!("{name} / peak memory of the process"),
                peak_memory() / particles as f64,
                "B/particle",
            )?;
        }
    }
    Ok(())
}

/// Some rows of a log.
fn part(log: &Log) -> Log {
    Log {
        time: log.time[ROWS].to_vec(),
        object: log.object[ROWS].to_vec(),
        object_covariance: Vec::new(),
        pusher: log.pusher[ROWS].to_vec(),
        other_fingers: Vec::new(),
        tactile: log
            .tactile
            .iter()
            .map(|sensor| sensor[ROWS].to_vec())
            .collect(),
        force: Vec::new(),
    }
}

/// Mean time per frame (s), over frames and rounds: a median would hide the rare steps that cost a
/// thousand times the others, which a small set meets in few frames and a large one in all.
fn frame_time(setup: &Setup, log: &Log, particles: usize) -> Result<f64, stickslip::RunError> {
    let options = RunOptions {
        model: FilterModel::Paper,
        particles,
        ..RunOptions::default()
    };
    let rounds = LEAST_WORK.div_ceil(particles * log.len());
    let mut frames = Vec::new();
    for _ in 0..rounds {
        let mut last = Instant::now();
        run(setup, log, &options, &mut |row| {
            let now = Instant::now();
            frames.extend((row >= WARM_UP).then_some((now - last).as_secs_f64()));
            last = now;
        })?;
    }
    Ok(frames.iter().sum::<f64>() / frames.len() as f64)
}

/// Most memory that the process has held so far (B); NaN where the system does not say.
fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| {
        rest.trim()
            .trim_end_matches("kB")
            .trim()
            .parse::<f64>()
            .ok()
    })
    .map_or(f64::NAN, |kib| kib * 1024.0)
}
