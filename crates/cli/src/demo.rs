//! `stickslip demo`: two embedded experiments, all variants, tables, figures and a page.

use anyhow::Result;
use rayon::prelude::*;
use stickslip::{FilterModel, Tracking};
use stickslip_evaluation::{RunConditions, Variant};
use stickslip_formats::Experiment;
use stickslip_report::{Block, Report, ReportedExperiment, ReportedRun, Section};

use crate::args::DemoArgs;
use crate::experiment::Texts;
use crate::files::{FIGURE_FORMATS, ready_folder, write_figures, write_file, write_report};
use crate::origin::origin;
use crate::output::show;
use crate::reported_run::reported_run;
use crate::verdict::Verdict;

/// Explanation at the end of the page.
const ABOUT: &str = "A pusher moves an object on a table into fixed bodies, called fixels. The camera turns off 0.2 s before the object \
    touches the first fixel. From then on, each method has the poses of the pusher, and the particle filter also has the touch sensors of the \
    fixels. All variants of the methods are in the tables; the figures show six of them. The experiments were chosen by a rule that no particle filter \
    decides: the median error of every baseline, the extended Kalman filter included, is above 2 mm.";

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

/// The experiments and their motions.
const EXPERIMENTS: [(Texts<'static>, &str); 2] = [
    (
        embedded!("turn-square-disc"),
        "a disc pushes a square between two fixels, where it turns",
    ),
    (
        embedded!("slide-pent-bar-97012"),
        "a bar pushes a pentagon, which slides into two fixels",
    ),
];

/// Runs the command.
pub fn demo(args: &DemoArgs) -> Result<Verdict> {
    ready_folder(&args.out)?;
    let pool = args.threads.pool()?;
    let mut sections = Vec::new();
    let mut figures = 0;
    for (texts, what) in EXPERIMENTS {
        let experiment = texts.parse()?;
        // the camera turns off just before the first fixel contact
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
        let moving = format!("{}-animation.svg", reported.name);
        write_file(
            &args.out.join(moving),
            reported.animation().to_svg().as_bytes(),
        )?;
        sections.push(reported.section());
    }
    sections.push(Section {
        title: "About these experiments".to_owned(),
        blocks: vec![Block::Text(ABOUT.to_owned())],
    });
    let report = Report {
        title: "stickslip: tracking a pushed object while the camera is off".to_owned(),
        summary: Vec::new(),
        sections,
        origin: origin([
            ("particles", args.particles.to_string()),
            ("seed", "0".to_owned()),
        ]),
    };
    let path = write_report(args.out.join("report.html"), &report)?;
    show(format_args!(
        "page: {} (open it in a browser)\nnext to it: {figures} figures as {FIGURE_FORMATS}, and two animations as SVG",
        path.display()
    ))?;
    Ok(Verdict::Done)
}

/// Runs of all variants that differ on the experiment.
fn runs(experiment: &Experiment, conditions: &RunConditions) -> Result<Vec<ReportedRun>> {
    let variants: Vec<Variant> =
        Variant::compared_on(&experiment.log, conditions.occlusion).collect();
    let runs = variants
        .into_par_iter()
        .map(|variant| reported_run(variant, experiment, conditions));
    Ok(runs.collect::<Result<_, _>>()?)
}

/// Sentences and scores.
fn tables(experiment: &ReportedExperiment<'_>) -> String {
    let sentences: Vec<String> = experiment
        .sentences()
        .iter()
        .map(ToString::to_string)
        .collect();
    format!(
        "{}\n{}\n\n{}",
        experiment.name,
        sentences.join("\n"),
        experiment.scores()
    )
}
