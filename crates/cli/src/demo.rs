//! `stickslip demo`: two embedded experiments through every method, with tables and figures.

use anyhow::Result;
use rayon::prelude::*;
use stickslip::{Estimate, FilterModel, Tracking};
use stickslip_evaluation::{LearnedParameter, RunConditions, Variant};
use stickslip_formats::Experiment;
use stickslip_report::{Block, Report, ReportedExperiment, ReportedRun, Table};

use crate::args::DemoArgs;
use crate::experiment::Texts;
use crate::files::{ready_folder, write_figures, write_report};
use crate::origin::origin;
use crate::output::show;
use crate::reported_run::reported_run;
use crate::verdict::Verdict;

/// What the report begins with.
const SUMMARY: &str = "Two grasps on a table, seen from above: a pusher moves an object against fixed fingers (fixels), and just before the \
    first one is touched the camera goes dark. From then on each method must guess where the object is. Below, each grasp can be played back.";

macro_rules! embedded {
    ($name:literal) => {
        Texts {
            name: $name,
            scene: include_str!(concat!("../demo/", $name, "/scene.toml")),
            log: include_str!(concat!("../demo/", $name, "/log.csv")),
            truth_csv: include_str!(concat!("../demo/", $name, "/truth.csv")),
            truth_json: include_str!(concat!("../demo/", $name, "/truth.json")),
        }
    };
}

/// The experiments, with what happens in them.
const EXPERIMENTS: [(Texts<'static>, &str); 2] = [
    (
        embedded!("stop-square50-bar-000"),
        "a bar pushes a square until it jams at a fixel",
    ),
    (
        embedded!("slide-ell-disc-110"),
        "a disc pushes an L-shaped plate, which slides and turns on two fixels",
    ),
];

/// Runs the command.
pub fn demo(args: &DemoArgs) -> Result<Verdict> {
    ready_folder(&args.out)?;
    let pool = args.threads.pool()?;
    let mut summary = vec![Block::Text(SUMMARY.to_owned())];
    let mut sections = Vec::new();
    let mut figures = 0;
    for (texts, what) in EXPERIMENTS {
        let experiment = texts.parse()?;
        // the camera is dark from just before the first fixel contact on
        let conditions = RunConditions {
            model: FilterModel::default(),
            particles: args.particles,
            tracking: Tracking::Smoothed,
            occlusion: experiment.facts.occlusion(),
            seed: 0,
        };
        let runs = pool.install(|| runs(&experiment, &conditions))?;
        let occlusion = conditions.occlusion;
        let reported = ReportedExperiment::new(texts.name, what, &experiment, occlusion, runs);
        show(format_args!("{}\n", tables(&reported)))?;
        figures += write_figures(&args.out, &reported)?;
        summary.extend(reported.summary());
        sections.push(reported.section());
    }
    let report = Report {
        title: "stickslip: tracking a pushed object through a camera blackout".to_owned(),
        summary,
        sections,
        origin: origin([
            ("particles", args.particles.to_string()),
            ("seed", "0".to_owned()),
        ]),
    };
    let path = write_report(args.out.join("report.html"), &report)?;
    show(format_args!(
        "report: {} (open it in a browser), and {figures} figures beside it as SVG and PNG",
        path.display()
    ))?;
    Ok(Verdict::Done)
}

/// Every variant that differs on the experiment.
fn runs(experiment: &Experiment, conditions: &RunConditions) -> Result<Vec<ReportedRun>> {
    let variants: Vec<Variant> = Variant::drawn_on(&experiment.log, conditions.occlusion).collect();
    let runs = variants
        .into_par_iter()
        .map(|variant| reported_run(variant, experiment, conditions));
    Ok(runs.collect::<Result<_, _>>()?)
}

fn tables(experiment: &ReportedExperiment<'_>) -> String {
    let sentences = experiment.story().sentences().join("\n");
    let scores = format!(
        "{}\n{sentences}\n\n{}",
        experiment.name,
        experiment.scores()
    );
    let mut runs = experiment.runs.iter().map(|run| &run.scored);
    let particle = runs.find(|run| run.variant == Variant::Particle);
    let friction = particle.map(|run| friction(experiment, &run.estimate).to_string());
    [scores]
        .into_iter()
        .chain(friction)
        .collect::<Vec<_>>()
        .join("\n")
}

/// The particle filter's friction beside its nominal and true values.
fn friction(experiment: &ReportedExperiment<'_>, estimate: &Estimate) -> Table {
    let nominal = &experiment.setup.scene.nominal;
    let mut table = Table::new(["friction", "nominal", "particle", "truth"]);
    for (parameter, truth) in LearnedParameter::all(estimate)
        .iter()
        .zip(experiment.friction)
    {
        table.push([
            parameter.name.to_owned(),
            parameter.shown_value(parameter.among(nominal)),
            parameter.shown(),
            parameter.shown_value(truth),
        ]);
    }
    table
}
