//! `stickslip demo`: two embedded experiments through every method, with tables and figures.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use rayon::prelude::*;
use stickslip::{Estimate, Occlusion, Tracking};
use stickslip_formats::Experiment;
use stickslip_report::{Curve, Mark, Panel, PoseError, Scale, TimeFigure, pose_errors};

use crate::args::DemoArgs;
use crate::compare::results::{Entry, Marks};
use crate::compare::tables;
use crate::contest::{Attempt, Rival, Rules};
use crate::experiment::Texts;
use crate::failure::hinted;
use crate::output::show;
use crate::parameters::Parameter;
use crate::table::Table;
use crate::verdict::Verdict;

/// Time that figures show after the last contact begins (s).
const AFTERMATH: f64 = 4.0;

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
    (embedded!("stop-square50-bar-000"), "a bar pushes a square until it jams at a fixel"),
    (embedded!("slide-pent-disc-118"), "a disc pushes a pentagon, which slides and turns on two fixels"),
];

/// Runs the command.
pub fn demo(args: &DemoArgs) -> Result<Verdict> {
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let mut between = "";
    for (texts, story) in EXPERIMENTS {
        let experiment = texts.parse()?;
        let attempts = pool.install(|| attempts(&experiment, args.particles))?;
        let path = write_figure(&args.out, texts.name, &figure(story, &experiment, &attempts)?)?;
        let tables = tables(texts.name, story, &experiment, &attempts);
        show(format_args!("{between}{tables}\nfigure: {}", path.display()))?;
        between = "\n";
    }
    Ok(Verdict::Done)
}

/// The camera is dark from just before the first fixel contact on.
fn occlusion(experiment: &Experiment) -> Occlusion {
    experiment.facts.occlude_from.map_or(Occlusion::None, |from| Occlusion::Rows { from, to: None })
}

fn attempts(experiment: &Experiment, particles: usize) -> Result<Vec<(Rival, Attempt)>> {
    let rules = Rules { particles, tracking: Tracking::Smoothed };
    let occlusion = occlusion(experiment);
    let attempt = |rival: Rival| Ok((rival, rival.attempt(experiment, occlusion, &rules, 0)?));
    Rival::on(experiment, occlusion).into_par_iter().map(attempt).collect()
}

fn tables(name: &str, story: &str, experiment: &Experiment, attempts: &[(Rival, Attempt)]) -> String {
    let dark = experiment.facts.occlude_from.map_or(0.0, |row| experiment.log.time[row]);
    let entries: Vec<Entry> =
        attempts.iter().map(|(rival, attempt)| Entry::new(*rival, Marks::new(&attempt.scores, attempt.run.unsolved))).collect();
    let scores = format!("{name}: {story}; no camera from {dark:.1} s on\n{}", tables::entries(&entries));
    let particle = attempts.iter().find(|(rival, _)| *rival == Rival::Particle);
    let friction = particle.map(|(_, attempt)| friction(experiment, &attempt.run.estimate).to_string());
    [scores].into_iter().chain(friction).collect::<Vec<_>>().join("\n")
}

/// The particle filter's friction beside what it was told and what is true.
fn friction(experiment: &Experiment, estimate: &Estimate) -> Table {
    let mut table = Table::new(["friction", "told", "particle", "truth"]);
    for parameter in Parameter::at_end(estimate) {
        let told = parameter.shown_value(parameter.nominal(&experiment.setup.scene.nominal));
        let truth = parameter.shown_value(parameter.truth(&experiment.facts));
        table.push([parameter.name.to_owned(), told, parameter.shown(), truth]);
    }
    table
}

fn figure(story: &str, experiment: &Experiment, attempts: &[(Rival, Attempt)]) -> Result<String> {
    let time_of = |row: usize| experiment.log.time.get(row).copied();
    let fixels = experiment.facts.first_fixel_contacts.iter().enumerate();
    let fixels = fixels.filter_map(|(k, row)| Some(Mark { time: time_of((*row)?)?, name: format!("fixel {}", k + 1) }));
    let pusher = experiment.facts.first_pusher_contact.and_then(time_of).map(|time| Mark { time, name: "pusher".to_owned() });
    let contacts: Vec<Mark> = pusher.into_iter().chain(fixels).collect();
    let last = experiment.log.time.last().copied().unwrap_or(0.0);
    let end = contacts.iter().map(|mark| mark.time + AFTERMATH).fold(0.0, f64::max).min(last);
    let panel = |label: &str, of: fn(&PoseError) -> f64| Panel {
        label: label.to_owned(),
        scale: Scale::Log { floor: 0.01 },
        curves: attempts.iter().map(|(rival, attempt)| curve(*rival, experiment, &attempt.run.estimate, of)).collect(),
        ..Panel::default()
    };
    let figure = TimeFigure {
        title: story.to_owned(),
        span: [contacts.iter().map(|mark| mark.time - 1.0).fold(end, f64::min).max(0.0), end],
        dark: experiment.facts.occlude_from.and_then(time_of).map(|from| [from, last]).into_iter().collect(),
        marks: contacts,
        panels: vec![panel("position error (mm)", PoseError::distance_mm), panel("angle error (°)", |error| error.turn_deg.abs())],
        ..TimeFigure::default()
    };
    Ok(figure.to_svg())
}

/// One kind of error of one method against the reference, row by row.
fn curve(rival: Rival, experiment: &Experiment, estimate: &Estimate, of: fn(&PoseError) -> f64) -> Curve {
    let errors = pose_errors(estimate, &experiment.reference());
    Curve::new(rival.name(), rival.colour(), errors.iter().map(|error| [error.time, of(error)]).collect())
}

fn write_figure(folder: &Path, name: &str, svg: &str) -> Result<PathBuf> {
    let path = folder.join(format!("{name}.svg"));
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&path, svg));
    written.map_err(|error| {
        hinted(format!("{}: cannot be written: {error}", path.display()), "give a folder that can be written to with --out")
    })?;
    Ok(path)
}
