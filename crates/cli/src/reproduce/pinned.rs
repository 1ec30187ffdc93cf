//! `stickslip reproduce --pinned`: touch against no touch on scenes in the paper's regime.

use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use stickslip_evaluation::Variant;
use stickslip_evaluation::paper::{
    PinnedCell, PinnedExperiment, PinnedResults, PinnedRow, PinnedScene, PinnedScores,
};
use stickslip_report::Table;

use crate::output::show_result;
use crate::progress::{Work, bar};
use crate::simulation_args::ReproduceArgs;
use crate::verdict::Verdict;

/// Seeds of the filter where the command line does not say.
const SEEDS: u64 = 10;

/// Description of the table.
const ABOUT: &str = "Scenes in which the nominal simulation and the Kalman filter have the paper's errors. Pose RMSE over all rows in mm: \
    median over scenes (10-90 %) of medians over seeds; the paper's number and the share of our scenes below it. \
    Touch is better or worse in a scene if the median difference over seeds exceeds two standard errors; p of the sign test.";

/// All that the command says.
#[derive(Debug, Serialize)]
struct Report {
    particles: usize,
    seeds: u64,
    model: &'static str,
    causal: bool,
    #[serde(flatten)]
    results: PinnedResults,
}

/// Runs the command.
pub fn pinned(args: &ReproduceArgs) -> Result<Verdict> {
    let seeds = args.seeds.unwrap_or(SEEDS);
    let results = args.threads.pool()?.install(|| results(args, seeds))?;
    let report = Report {
        particles: args.particles,
        seeds,
        model: args.model.name(),
        causal: args.causal,
        results,
    };
    show_result(args.json, &report, || {
        format!("{ABOUT}\n\n{}", table(&report.results.rows))
    })?;
    Ok(Verdict::Done)
}

fn results(args: &ReproduceArgs, seeds: u64) -> Result<PinnedResults> {
    let scenes = PinnedScene::all();
    let progress = bar(scenes.len(), "scenes", Work::Long);
    let score = |scene: &PinnedScene| {
        let experiment = scene.simulate()?;
        let scores = scores(scene, &experiment, args, seeds);
        progress.inc(1);
        scores
    };
    let scores = scenes.par_iter().map(score).collect::<Result<_>>()?;
    progress.finish_and_clear();
    Ok(PinnedResults::new(scores))
}

fn scores(
    scene: &PinnedScene,
    experiment: &PinnedExperiment,
    args: &ReproduceArgs,
    seeds: u64,
) -> Result<PinnedScores> {
    let score = |variant, seed| -> Result<f64> {
        let run = experiment.run(variant, seed, args.settings())?;
        Ok(run.scores.wmse_mm.expect("every row has a truth"))
    };
    let of = |variant| (0..seeds).map(|seed| score(variant, seed)).collect();
    let without_touch_mm: Result<Vec<f64>> = of(Variant::ParticleNoTouch);
    let with_touch_mm: Result<Vec<f64>> = of(Variant::Particle);
    Ok(PinnedScores {
        name: scene.name.clone(),
        group: scene.group,
        without_touch_mm: without_touch_mm?,
        with_touch_mm: with_touch_mm?,
        camera_on_mm: score(Variant::ParticleCameraOn, 0)?,
    })
}

fn table(rows: &[PinnedRow]) -> Table {
    let mut table = Table::new([
        "experiment",
        "scenes",
        "without touch",
        "paper",
        "below it",
        "with touch",
        "paper",
        "below it",
        "camera on",
        "touch better/unclear/worse",
        "p",
    ]);
    for row in rows {
        let touch = row.touch;
        let [without, with] = [row.without_touch, row.with_touch].map(cells);
        let cells = [row.title.clone(), row.scenes.to_string()]
            .into_iter()
            .chain(without)
            .chain(with)
            .chain([
                format!("{:.2}", row.camera_on.ours_mm.median),
                format!("{}/{}/{}", touch.better, touch.unclear, touch.worse),
                format!("{:.2}", touch.p_value),
            ]);
        table.push(cells);
    }
    table
}

/// Ours, the paper's number, and the share of ours below it.
fn cells(cell: PinnedCell) -> [String; 3] {
    let ours = cell.ours_mm;
    let shown = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    [
        format!("{:.2} ({:.2}-{:.1})", ours.median, ours.low, ours.high),
        shown(cell.paper_mm.map(|mm| format!("{mm:.2}"))),
        shown(
            cell.paper_quantile
                .map(|share| format!("{:.0} %", 100.0 * share)),
        ),
    ]
}
