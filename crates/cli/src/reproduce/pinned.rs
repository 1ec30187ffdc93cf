//! `stickslip reproduce --pinned`: touch against no touch on scenes in the paper's regime.

use std::path::Path;

use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use stickslip_evaluation::paper::{
    PinnedCell, PinnedExperiment, PinnedGroup, PinnedResults, PinnedRow, PinnedScene, PinnedScores,
};
use stickslip_evaluation::{Variant, quantile};
use stickslip_report::{Block, Colour, Report as Page, StripGroup, StripLane, StripPlot, Table};

use crate::files::{ready_folder, write_figure, write_file, write_report};
use crate::origin::origin;
use crate::output::{show_result, talk};
use crate::progress::{Work, bar};
use crate::simulation_args::ReproduceArgs;
use crate::verdict::Verdict;

/// Seeds of the filter where the command line does not say.
const SEEDS: u64 = 10;

/// Description of the table.
const ABOUT: &str = "Scenes in which the nominal simulation and the Kalman filter have the paper's errors. Pose RMSE over all rows in mm: \
    median over scenes (10-90 %) of medians over seeds; the paper's number and the share of our scenes below it. \
    Touch is better or worse in a scene if the median difference over seeds exceeds two standard errors; p of the sign test.";

/// Caption of the figure.
const CAPTION: &str =
    "A dot is a scene: its median over seeds, camera off. Bars are the medians of the scenes.";

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
    if let Some(folder) = &args.out {
        ready_folder(folder)?;
    }
    let seeds = args.seeds.unwrap_or(SEEDS);
    let results = args.threads.pool()?.install(|| results(args, seeds))?;
    let report = Report {
        particles: args.particles,
        seeds,
        model: args.model.name(),
        causal: args.causal,
        results,
    };
    if let Some(folder) = &args.out {
        write(folder, &report)?;
    }
    show_result(args.json, &report, || {
        format!("{ABOUT}\n\n{}", table(&report.results.rows))
    })?;
    Ok(Verdict::Done)
}

/// Writes pinned.json, the figure and report.html.
fn write(folder: &Path, report: &Report) -> Result<()> {
    let drawing = strip(&report.results).drawing();
    write_figure(folder, "pinned", &drawing)?;
    let json = serde_json::to_string_pretty(report)?;
    write_file(&folder.join("pinned.json"), json.as_bytes())?;
    let page = Page {
        title: "stickslip reproduce --pinned: touch against no touch in the paper's regime"
            .to_owned(),
        summary: vec![
            Block::Figure(drawing, CAPTION.to_owned()),
            Block::Table(table(&report.results.rows), ABOUT.to_owned()),
        ],
        origin: origin([
            ("seeds", report.seeds.to_string()),
            ("particles", report.particles.to_string()),
            ("model", report.model.to_owned()),
        ]),
        sections: Vec::new(),
    };
    let page = write_report(folder.join("report.html"), &page)?;
    talk(format_args!(
        "wrote pinned.svg, pinned.json and {}",
        page.display()
    ));
    Ok(())
}

/// Every scene's median over seeds, with the paper's number.
fn strip(results: &PinnedResults) -> StripPlot {
    let lane =
        |group: PinnedGroup, variant: Variant, name: &str, of: fn(&PinnedScores) -> &[f64]| {
            let own = results.scenes.iter().filter(|scene| scene.group == group);
            StripLane {
                name: name.to_owned(),
                colour: Colour::of(variant),
                values: own.filter_map(|scene| quantile(of(scene), 0.5)).collect(),
                mark: group.published(variant),
            }
        };
    let group = |group: PinnedGroup| StripGroup {
        name: group.name().to_owned(),
        lanes: vec![
            lane(group, Variant::ParticleNoTouch, "without touch", |scene| {
                &scene.without_touch_mm
            }),
            lane(group, Variant::Particle, "with touch", |scene| {
                &scene.with_touch_mm
            }),
        ],
    };
    StripPlot {
        label: "errors of all scenes without and with touch, experiment by experiment".to_owned(),
        x_label: "pose RMSE over all rows (mm)".to_owned(),
        floor: 0.05,
        mark_name: "paper".to_owned(),
        groups: PinnedGroup::ALL.map(group).into(),
    }
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
