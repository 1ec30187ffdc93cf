//! `stickslip reproduce --pinned`: touch against no touch on scenes in the paper's regime.

use std::path::Path;

use anyhow::{Result, bail};
use rayon::prelude::*;
use serde::Serialize;
use stickslip_evaluation::paper::{
    PinnedCell, PinnedGroup, PinnedResults, PinnedRow, PinnedScene, PinnedScores, Replicate,
    RunSet, RunSettings,
};
use stickslip_evaluation::{Variant, quantile};
use stickslip_report::{
    Block, Colour, Figure, Report as Page, StripGroup, StripLane, StripPlot, Table,
};

use super::figures::figures;
use super::page::{figures_section, paper_strip};
use super::runs;
use crate::args::ModelName;
use crate::files::{ready_folder, write_figure, write_file, write_report};
use crate::origin::origin;
use crate::output::{show_result, talk};
use crate::progress::{Work, bar};
use crate::simulation_args::ReproduceArgs;
use crate::verdict::Verdict;

/// Seeds of the filter where the command line does not say.
const SEEDS: u64 = 10;

/// Scenes of the paper's figures: one of A, one of B. They were chosen by their results, to show
/// what the paper's figures show.
const STORIES: [&str; 2] = ["A-201-000273", "B-202-000157"];

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
    /// Force noise of the paper's model, where the command line gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    force_std: Option<f64>,
    #[serde(flatten)]
    results: PinnedResults,
}

/// Runs the command.
pub fn pinned(args: &ReproduceArgs) -> Result<Verdict> {
    if args.force_std.is_some() && args.model != ModelName::Paper {
        bail!("--force-std is the force noise of --model paper; leave one of the two out");
    }
    if let Some(folder) = &args.out {
        ready_folder(folder)?;
    }
    let seeds = args.seeds.unwrap_or(SEEDS);
    let pool = args.threads.pool()?;
    let results = pool.install(|| results(args, seeds))?;
    let report = Report {
        particles: args.particles,
        seeds,
        model: args.model.name(),
        causal: args.causal,
        force_std: args.force_std,
        results,
    };
    if let Some(folder) = &args.out {
        let stories = pool.install(|| stories(args, seeds))?;
        write(folder, &report, &stories)?;
    }
    show_result(args.json, &report, || {
        format!("{ABOUT}\n\n{}", table(&report.results.rows))
    })?;
    Ok(Verdict::Done)
}

/// A scene as the testbed simulates it, with the force noise of the command line.
fn simulated(scene: &PinnedScene, args: &ReproduceArgs) -> Result<Replicate> {
    let mut replicate = scene.simulate()?;
    let noise = &mut replicate.experiment.setup.filter.force_std;
    *noise = args.force_std.unwrap_or(*noise);
    Ok(replicate)
}

/// All variants on the scenes of the paper's figures.
fn stories(args: &ReproduceArgs, seeds: u64) -> Result<Vec<RunSet>> {
    let mut replicates = Vec::new();
    for name in STORIES {
        let first = simulated(&PinnedScene::named(name), args)?;
        replicates.extend((0..seeds).map(|seed| Replicate {
            seed,
            ..first.clone()
        }));
    }
    runs(replicates, args.settings())
}

/// Writes pinned.json, the figures and report.html.
fn write(folder: &Path, report: &Report, stories: &[RunSet]) -> Result<()> {
    let drawing = strip(&report.results).drawing();
    write_figure(folder, "pinned", &drawing)?;
    let figures = figures(stories, STORIES);
    for Figure { name, drawing, .. } in &figures {
        write_figure(folder, name, drawing)?;
    }
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
        sections: vec![figures_section(
            "Figures 1 to 7, in two of the scenes",
            &figures,
        )],
    };
    let page = write_report(folder.join("report.html"), &page)?;
    talk(format_args!(
        "wrote pinned.svg, fig1.svg to fig7.svg, pinned.json and {}",
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
                ..StripLane::default()
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
    let label = "errors of all scenes without and with touch, experiment by experiment";
    paper_strip(label.to_owned(), PinnedGroup::ALL.map(group).into())
}

fn results(args: &ReproduceArgs, seeds: u64) -> Result<PinnedResults> {
    let scenes = PinnedScene::all();
    let progress = bar(scenes.len(), "scenes", Work::Long);
    let score = |scene: &PinnedScene| {
        let replicate = simulated(scene, args)?;
        let scores = scores(scene, replicate, args.settings(), seeds);
        progress.inc(1);
        scores
    };
    let scores = scenes.par_iter().map(score).collect::<Result<_>>()?;
    progress.finish_and_clear();
    Ok(PinnedResults::new(scores))
}

fn scores(
    scene: &PinnedScene,
    mut replicate: Replicate,
    settings: RunSettings,
    seeds: u64,
) -> Result<PinnedScores> {
    let mut score = |variant, seed| -> Result<f64> {
        replicate.seed = seed;
        let run = replicate.run(variant, settings)?;
        Ok(run.scores.wmse_mm.expect("every row has a truth"))
    };
    let mut of = |variant| (0..seeds).map(|seed| score(variant, seed)).collect();
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
