//! `stickslip demo`: two embedded experiments through every method, with tables and figures.

use anyhow::Result;
use rayon::prelude::*;
use stickslip::{Estimate, Occlusion, Tracking};
use stickslip_formats::Experiment;
use stickslip_report::{Block, Contender, Episode, Report, Table};

use crate::args::DemoArgs;
use crate::contest::{Rival, Rules};
use crate::episode::{contender, episode, write_figures, write_report};
use crate::experiment::Texts;
use crate::output::show;
use crate::parameters::Parameter;
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
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let experiments = EXPERIMENTS.map(|(texts, what)| {
        texts
            .parse()
            .map(|experiment| (texts.name, what, experiment))
    });
    let mut summary = vec![Block::Text(SUMMARY.to_owned())];
    let mut sections = Vec::new();
    let mut figures = 0;
    for parsed in experiments {
        let (name, what, experiment) = parsed?;
        let occlusion = occlusion(&experiment);
        let contenders = pool.install(|| contenders(&experiment, occlusion, args.particles))?;
        let episode = episode(name, what, &experiment, occlusion, contenders);
        show(format_args!("{}\n", tables(&episode)))?;
        figures += write_figures(&args.out, &episode)?;
        summary.extend(episode.summary());
        sections.push(episode.section());
    }
    let report = Report {
        title: "stickslip: tracking a pushed object through a camera blackout".to_owned(),
        summary,
        sections,
    };
    let path = write_report(args.out.join("report.html"), &report)?;
    show(format_args!(
        "report: {} (open it in a browser), and {figures} figures beside it as SVG and PNG",
        path.display()
    ))?;
    Ok(Verdict::Done)
}

/// The camera is dark from just before the first fixel contact on.
fn occlusion(experiment: &Experiment) -> Occlusion {
    experiment
        .facts
        .occlude_from
        .map_or(Occlusion::None, |from| Occlusion::Rows { from, to: None })
}

fn contenders(
    experiment: &Experiment,
    occlusion: Occlusion,
    particles: usize,
) -> Result<Vec<Contender>> {
    let rules = Rules {
        particles,
        tracking: Tracking::Smoothed,
    };
    let contender = |rival: Rival| contender(rival, experiment, occlusion, &rules, 0);
    Rival::on(experiment, occlusion)
        .into_par_iter()
        .map(contender)
        .collect()
}

fn tables(episode: &Episode<'_>) -> String {
    let sentences = episode.story().sentences().join("\n");
    let particle = episode
        .methods
        .iter()
        .find(|method| method.name == Rival::Particle.title());
    let friction = particle.map(|method| friction(episode, &method.estimate).to_string());
    let scores = format!("{}\n{sentences}\n\n{}", episode.name, episode.scores());
    [scores]
        .into_iter()
        .chain(friction)
        .collect::<Vec<_>>()
        .join("\n")
}

/// The particle filter's friction beside what it was told and what is true.
fn friction(episode: &Episode<'_>, estimate: &Estimate) -> Table {
    let mut table = Table::new(["friction", "told", "particle", "truth"]);
    for (parameter, truth) in Parameter::at_end(estimate).iter().zip(episode.friction) {
        let told = parameter.shown_value(parameter.nominal(&episode.setup.scene.nominal));
        table.push([
            parameter.name.to_owned(),
            told,
            parameter.shown(),
            parameter.shown_value(truth),
        ]);
    }
    table
}
