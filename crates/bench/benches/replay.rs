//! `cargo bench -p stickslip-bench --bench replay`: the steps of the particle filter on every
//! `slide-*` log, captured, then solved again.
//!
//! `... -- NAME` takes the logs with NAME in their names. 500 particles, camera hidden where the
//! log's `truth.json` says so. Only the solver's step is timed, one block of the filter at a time,
//! on one thread; every step starts from the filter's particles, noise and warm start included.
//!
//! A block hides the cost of one particle, so each particle's step is also timed alone, as a chunk
//! of one lane: that costs more than its share of a block. A thread that has to wait for a
//! processor seems slow; so the shortest of [`ALONE_ROUNDS`] times counts.

use std::error::Error;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use stickslip::{FilterModel, Observer, Occlusion, RunOptions, SolvedStep, quantile, run_observed};
use stickslip_bench::{FilterBlock, LANES, Results, StepStatistics, instruction_sets};
use stickslip_dynamics::{Dynamics, Particles, StepInput, StepWork};
use stickslip_experiments::{RecordedCase, recorded_cases};
use stickslip_testkit::data_root;

/// Rounds that are counted.
const ROUNDS: usize = 3;

/// Times that each particle's step is made alone.
const ALONE_ROUNDS: usize = 3;

/// One block before a step.
#[derive(Debug)]
struct Captured {
    input: StepInput,
    chunks: usize,
    particles: FilterBlock,
}

/// Keeps the start of every step.
#[derive(Debug, Default)]
struct Capture(Mutex<Vec<Captured>>);

impl Observer for Capture {
    fn on_step(&self, _step: &SolvedStep<'_>) {}

    fn before_step(&self, input: &StepInput, particles: &[Particles<LANES>]) {
        let mut kept = Captured {
            input: *input,
            chunks: particles.len(),
            particles: FilterBlock::default(),
        };
        kept.particles[..particles.len()].copy_from_slice(particles);
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(kept);
    }
}

/// Cost of the replay of some logs.
#[derive(Debug, Default)]
struct Cost {
    /// Time per particle-step of every block, rounds together (ns).
    blocks: Vec<f64>,
    /// Time of every particle-step made alone (ns).
    alone: Vec<f32>,
    /// All time (ns) and all particle-steps, rounds together.
    total: [f64; 2],
    statistics: StepStatistics,
}

fn main() -> Result<(), Box<dyn Error>> {
    let root = data_root().ok_or("no recorded experiments: point STICKSLIP_DATA at them")?;
    let sets = instruction_sets();
    let mut costs: Vec<Cost> = sets.iter().map(|_| Cost::default()).collect();
    let mut results = Results::open()?;
    for case in recorded_cases(&root.join("mujoco"))?
        .iter()
        .filter(|case| is_wanted(case))
    {
        let steps = capture(case)?;
        let mut medians = Vec::new();
        for ((_, level), cost) in sets.iter().zip(&mut costs) {
            let dynamics = Dynamics::new(case.setup.scene.clone()).with_level(*level);
            medians.push(replay(&dynamics, &steps, cost));
            cost.alone.extend(replay_alone(&dynamics, &steps));
        }
        let name = case
            .folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        results.write(
            &format!("replay / {} / {name}", sets[0].0),
            medians[0],
            "ns/particle-step",
        )?;
    }
    for ((name, _), cost) in sets.iter().zip(&costs) {
        write(name, cost, &mut results)?;
    }
    Ok(())
}

fn is_wanted(case: &RecordedCase) -> bool {
    let slides = case
        .folder
        .file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with("slide-"));
    let has = |part: &String| case.folder.to_string_lossy().contains(part.as_str());
    let asked_for: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with('-'))
        .collect();
    slides
        && case.occlusion != Occlusion::None
        && (asked_for.is_empty() || asked_for.iter().any(has))
}

fn capture(case: &RecordedCase) -> Result<Vec<Captured>, Box<dyn Error>> {
    let capture = Capture::default();
    let options = RunOptions {
        model: FilterModel::Paper,
        occlusion: case.occlusion,
        ..RunOptions::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| run_observed(&case.setup, &case.log, &options, &capture, &mut |_| ()))?;
    Ok(capture
        .0
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner))
}

/// Adds to `cost`; returns the mean time per particle-step of the median round (ns).
fn replay(dynamics: &Dynamics, steps: &[Captured], cost: &mut Cost) -> Option<f64> {
    let mut work = StepWork::default();
    let mut rounds = Vec::new();
    for round in 0..=ROUNDS {
        let [mut time, mut count] = [0.0; 2];
        for step in steps {
            let (mut block, lanes) = (step.particles, (step.chunks * LANES) as f64);
            let start = Instant::now();
            dynamics.step_block(&step.input, &mut block[..step.chunks], &mut work);
            let taken = start.elapsed().as_nanos() as f64;
            time += taken;
            count += lanes;
            if round > 0 {
                cost.blocks.push(taken / lanes);
                work.reports()
                    .as_flattened()
                    .iter()
                    .for_each(|report| cost.statistics.count(report));
            }
        }
        if round > 0 {
            rounds.push(time / count);
            cost.total = [cost.total[0] + time, cost.total[1] + count];
        }
    }
    quantile(&rounds, 0.5)
}

/// Time of every particle-step, made alone (ns).
fn replay_alone(dynamics: &Dynamics, steps: &[Captured]) -> Vec<f32> {
    let mut work = StepWork::<1>::default();
    let mut times = Vec::new();
    for step in steps {
        for chunk in &step.particles[..step.chunks] {
            for lane in 0..LANES {
                let friction = chunk.friction.map(|x| x.0[lane]);
                let took = (0..ALONE_ROUNDS).map(|_| {
                    let mut particle = [chunk.get(lane)];
                    let start = Instant::now();
                    dynamics.step(&step.input, &[friction], &mut particle, &mut work);
                    start.elapsed().as_nanos() as f32
                });
                times.push(took.fold(f32::INFINITY, f32::min));
            }
        }
    }
    times
}

fn write(name: &str, cost: &Cost, results: &mut Results) -> std::io::Result<()> {
    let name = format!("replay / {name} / all logs");
    results.write(
        &format!("{name} / mean"),
        cost.total[0] / cost.total[1],
        "ns/particle-step",
    )?;
    results.write(
        &format!("{name} / median of blocks"),
        quantile(&cost.blocks, 0.5),
        "ns/particle-step",
    )?;
    results.write(
        &format!("{name} / p99 of blocks"),
        quantile(&cost.blocks, 0.99),
        "ns/particle-step",
    )?;
    let alone: Vec<f64> = cost.alone.iter().map(|&x| f64::from(x)).collect();
    for (what, share) in [
        ("median", 0.5),
        ("p99", 0.99),
        ("p99.99", 0.9999),
        ("slowest", 1.0),
    ] {
        let time = quantile(&alone, share);
        results.write(&format!("{name} / {what} of steps alone"), time, "ns")?;
    }
    results.write(
        &format!("{name} / iterations"),
        cost.statistics.mean_iterations(),
        "1",
    )?;
    results.write(
        &format!("{name} / p99 of iterations"),
        cost.statistics.iterations_quantile(0.99) as f64,
        "1",
    )?;
    results.write(
        &format!("{name} / worst residual"),
        cost.statistics.worst_residual(),
        "m/s",
    )?;
    results.write(
        &format!("{name} / fallback"),
        cost.statistics.fallback_share(),
        "1",
    )?;
    results.write(
        &format!("{name} / unsolved"),
        cost.statistics.unsolved() as f64 / cost.statistics.steps() as f64,
        "1",
    )?;
    for (route, share) in cost.statistics.route_shares() {
        results.write(&format!("{name} / by {route}"), share, "1")?;
    }
    Ok(())
}
