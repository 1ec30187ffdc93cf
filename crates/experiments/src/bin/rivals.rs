//! Two methods that the paper argues against, next to its own: noise on the particles' poses
//! (§III-B), and polygons in the place of quadratic friction cones (§II-B). It prints two Markdown
//! tables.
//!
//! ```text
//! cargo run --release -p stickslip-experiments --bin rivals [SEEDS [PARTICLES]]
//! ```
//!
//! It runs all pinned scenes, and 100 random ones for the cones. All but the times is reproducible.

use std::error::Error;
use std::time::Instant;

use rayon::prelude::*;
use stickslip::{FilterModel, Log, NominalPredictor, RunError, Setup, Tracking, quantile};
use stickslip_evaluation::paper::{PinnedScene, Replicate, RunSettings};
use stickslip_evaluation::{RunConditions, ScoredRun, Variant};
use stickslip_experiments::{ClosedLoop, ConeRollout, OverlapCount, PolygonCone, PoseNoise};

/// Distance of the end from which on a track counts as lost (mm).
const LOST_MM: f64 = 10.0;

/// Turns of the polygons, as shares of a side.
const TURNS: [f64; 2] = [0.0, 0.5];

/// Random scenes.
const RANDOM: ClosedLoop = ClosedLoop {
    seed: 1,
    frames: 90,
    particles: 1,
};
const RANDOM_SCENES: u64 = 100;

/// A particle filter with touch.
#[derive(Clone, Copy)]
enum Method {
    /// The paper's model; true if friction stays nominal.
    Paper(bool),
    /// Noise on positions (m).
    PoseNoise(f64),
}

const METHODS: [(Method, &str); 6] = [
    (Method::Paper(false), "paper's model"),
    (Method::Paper(true), "paper's model, nominal friction"),
    (Method::PoseNoise(3e-5), "pose noise 0.03 mm"),
    (Method::PoseNoise(1e-4), "pose noise 0.1 mm"),
    (Method::PoseNoise(3e-4), "pose noise 0.3 mm"),
    (Method::PoseNoise(1e-3), "pose noise 1 mm"),
];

/// Runs of one method on one scene, seed by seed.
#[derive(Default)]
struct Runs {
    occluded_mm: Vec<f64>,
    end_mm: Vec<f64>,
    overlapping: Vec<f64>,
    collapses: u32,
    seconds: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Result<Vec<usize>, _> = std::env::args().skip(1).map(|n| n.parse()).collect();
    let numbers = numbers?;
    let seeds = numbers.first().copied().unwrap_or(3);
    let particles = numbers.get(1).copied().unwrap_or(250);
    let scenes = PinnedScene::all();
    let pinned: Result<Vec<_>, _> = scenes.par_iter().map(PinnedScene::simulate).collect();
    let pinned = pinned?;

    println!(
        "Pose RMSE over the occluded rows, {} pinned scenes, {particles} particles, {seeds} seeds: \
         median / 90 % quantile over scenes of medians over seeds.\n\n\
         | scenes | filter with touch | error mm | below paper's model, its nominal friction | lost tracks | collapses | overlap | time |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |",
        pinned.len()
    );
    let run = |experiment: &Replicate| -> Result<Vec<Runs>, RunError> {
        let methods = METHODS.iter();
        let runs = methods.map(|(method, _)| runs(*method, experiment, seeds as u64, particles));
        runs.collect()
    };
    let all: Result<Vec<Vec<Runs>>, _> = pinned.par_iter().map(run).collect();
    let all: Vec<_> = scenes.iter().zip(all?).collect();
    for (kind, slides) in [("slides", true), ("stops", false)] {
        let own = all.iter().filter(|(s, _)| s.group.slides() == slides);
        let own: Vec<&Vec<Runs>> = own.map(|(_, runs)| runs).collect();
        for k in 0..METHODS.len() {
            filter_row(kind, &own, k);
        }
    }

    println!(
        "\nNominal simulation: distance of the ends from those of the quadratic cone, and of two \
         polygons turned by half a side, median / 90 % quantile; medians of unknowns and of the \
         time of moving steps.\n\n\
         | scenes | cone | off mm | turned mm | unknowns | µs a step | steps | no solution | inexact | at rest |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    let pinned = pinned.iter().map(|pinned| &pinned.experiment);
    let pinned: Vec<_> = pinned.map(|e| (e.setup.clone(), e.log.clone())).collect();
    cone_rows("pinned", &pinned)?;
    let random = (0..RANDOM_SCENES).map(|index| RANDOM.setup_and_log(index));
    cone_rows("random", &random.collect::<Vec<_>>())?;
    Ok(())
}

/// Runs a method on one scene.
fn runs(
    method: Method,
    pinned: &Replicate,
    seeds: u64,
    particles: usize,
) -> Result<Runs, RunError> {
    let settings = RunSettings {
        model: FilterModel::Paper,
        particles,
        tracking: Tracking::Smoothed,
    };
    let mut pinned = pinned.clone();
    if let Method::Paper(true) = method {
        pinned.experiment.setup.filter.parameter_std = 0.0;
    }
    let mut runs = Runs::default();
    for seed in 0..seeds {
        let began = Instant::now();
        let (scores, collapses) = match method {
            Method::Paper(_) => {
                pinned.seed = seed;
                let run = pinned.run(Variant::Particle, settings)?;
                (run.scores, run.collapses)
            }
            Method::PoseNoise(position_std) => {
                let options = PoseNoise {
                    position_std,
                    particles,
                    seed,
                };
                let run = options.run(&pinned.experiment, pinned.occlusion)?;
                runs.overlapping.push(run.overlapping);
                (run.scores, run.collapses)
            }
        };
        runs.seconds += began.elapsed().as_secs_f64();
        runs.occluded_mm.extend(scores.wmse_occluded_mm);
        runs.end_mm.extend(scores.final_error_mm);
        runs.collapses += collapses;
    }
    if let Method::Paper(_) = method {
        let experiment = &pinned.experiment;
        let conditions = RunConditions {
            model: settings.model,
            particles,
            tracking: settings.tracking,
            occlusion: pinned.occlusion,
            seed: 0,
        };
        let count = OverlapCount::new(&experiment.setup.scene);
        ScoredRun::new(Variant::Particle, experiment, &conditions, Some(&count))?;
        runs.overlapping.push(count.share());
    }
    Ok(runs)
}

/// Prints the row of method `k` over some scenes; methods 0 and 1 are the paper's.
fn filter_row(kind: &str, scenes: &[&Vec<Runs>], k: usize) {
    let error = |runs: &Runs| quantile(&runs.occluded_mm, 0.5).unwrap_or(f64::NAN);
    let errors: Vec<f64> = scenes.iter().map(|runs| error(&runs[k])).collect();
    let below = |other: usize| {
        let below = |runs: &&&Vec<Runs>| error(&runs[k]) < error(&runs[other]);
        scenes.iter().filter(below).count()
    };
    let ends: Vec<f64> = scenes
        .iter()
        .flat_map(|runs| &runs[k].end_mm)
        .copied()
        .collect();
    let time = |k: usize| scenes.iter().map(|runs| runs[k].seconds).sum::<f64>();
    let overlaps = scenes.iter().flat_map(|runs| &runs[k].overlapping).copied();
    let overlaps: Vec<f64> = overlaps.collect();
    let mean = 1e2 * overlaps.iter().sum::<f64>() / overlaps.len() as f64;
    println!(
        "| {kind} | {} | {} | {}, {} of {} | {} of {} | {} | {mean:.1} % | {:.2} |",
        METHODS[k].1,
        median_and_high(&errors),
        below(0),
        below(1),
        scenes.len(),
        ends.iter().filter(|end| **end > LOST_MM).count(),
        ends.len(),
        scenes.iter().map(|runs| runs[k].collapses).sum::<u32>(),
        time(k) / time(0),
    );
}

/// Prints the rows of all cones over some scenes.
fn cone_rows(name: &str, scenes: &[(Setup, Log)]) -> Result<(), RunError> {
    let name = format!("{} {name}", scenes.len());
    let rollouts = |cone: Option<PolygonCone>| -> Result<Vec<ConeRollout>, RunError> {
        let rollout = |(setup, log): &(Setup, Log)| {
            let predictor = NominalPredictor::new(setup, log)?;
            Ok(ConeRollout::new(setup, &predictor, cone))
        };
        scenes.par_iter().map(rollout).collect()
    };
    let apart = |a: &[ConeRollout], b: &[ConeRollout]| -> Vec<f64> {
        let pairs = a.iter().zip(b).zip(scenes);
        pairs
            .map(|((a, b), (setup, _))| 1e3 * a.distance(b, setup.virtual_radius()))
            .collect()
    };
    let quadratic = rollouts(None)?;
    println!("| {name} | quadratic | – | – | {} |", costs(&quadratic));
    for sides in [4, 6, 8, 16] {
        let [one, other] = TURNS.map(|turn| rollouts(Some(PolygonCone { sides, turn })));
        let (mut one, mut other) = (one?, other?);
        let off = [apart(&one, &quadratic), apart(&other, &quadratic)].concat();
        let (off, turned) = (median_and_high(&off), median_and_high(&apart(&one, &other)));
        one.append(&mut other);
        println!(
            "| {name} | {sides} sides | {off} | {turned} | {} |",
            costs(&one)
        );
    }
    Ok(())
}

/// Cells of the unknowns, the time and the outcomes.
fn costs(rollouts: &[ConeRollout]) -> String {
    let median = |of: fn(&ConeRollout) -> &[f64]| {
        let all: Vec<f64> = rollouts.iter().flat_map(of).copied().collect();
        quantile(&all, 0.5).unwrap_or(f64::NAN)
    };
    let total = |of: fn(&ConeRollout) -> usize| rollouts.iter().map(of).sum::<usize>();
    format!(
        "{:.0} | {:.1} | {} | {} | {} | {}",
        median(|rollout| &rollout.unknowns),
        1e6 * median(|rollout| &rollout.seconds),
        total(|rollout| rollout.steps),
        total(|rollout| rollout.infeasible),
        total(|rollout| rollout.failed),
        total(|rollout| rollout.rests),
    )
}

fn median_and_high(values: &[f64]) -> String {
    let at = |share| quantile(values, share).unwrap_or(f64::NAN);
    format!("{:.2} / {:.2}", at(0.5), at(0.9))
}
