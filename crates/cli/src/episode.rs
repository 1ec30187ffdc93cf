//! What a report is made from: an experiment with its runs as an [`Episode`], and pages and figures
//! into files.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip::Occlusion;
use stickslip_formats::Experiment;
use stickslip_report::{CloudSample, Contender, Drawing, Episode, Mark, Report, png_of};

use crate::contest::{Attempt, Rival, Rules};
use crate::experiment::reference_name;
use crate::failure::hinted;

/// Particles that are drawn.
pub const DRAWN: usize = 60;

/// The experiment with `methods` on it while `occlusion` hid the object.
pub fn episode<'a>(
    name: &str,
    what: &str,
    experiment: &'a Experiment,
    occlusion: Occlusion,
    methods: Vec<Contender>,
) -> Episode<'a> {
    let Experiment {
        setup, log, facts, ..
    } = experiment;
    let time_of = |row: &usize| log.time.get(*row).copied();
    let fixels = || {
        facts
            .first_fixel_contacts
            .iter()
            .enumerate()
            .filter_map(|(k, row)| Some((k, time_of(row.as_ref()?)?)))
    };
    let pusher = facts
        .first_pusher_contact
        .as_ref()
        .and_then(time_of)
        .map(|time| Mark {
            time,
            name: "pusher".to_owned(),
        });
    Episode {
        name: name.to_owned(),
        what: what.to_owned(),
        setup,
        log,
        reference: experiment.reference(),
        reference_name: reference_name(experiment)
            .trim_start_matches("the ")
            .to_owned(),
        hidden: occlusion.hidden(log),
        touches: touches(experiment),
        contacts: pusher
            .into_iter()
            .chain(fixels().map(|(k, time)| Mark {
                time,
                name: format!("fixel {}", k + 1),
            }))
            .collect(),
        first_fixel: fixels().map(|(_, time)| time).reduce(f64::min),
        friction: [facts.mu_s, facts.mu_p, facts.mu_f, facts.d_tri],
        methods,
    }
}

/// Whether the object touches the pusher, then each fixel, by the true forces; `None` where the
/// truth has none.
fn touches(experiment: &Experiment) -> Vec<Option<Vec<bool>>> {
    let by_force = |force: Option<&Vec<f64>>| {
        let (truth, force) = (
            experiment.truth.as_ref()?,
            force.filter(|force| !force.is_empty())?,
        );
        // a row of the truth within half a millisecond of the log's
        let at = |time: &f64| {
            truth
                .time
                .get(truth.time.partition_point(|t| *t < time - 5e-4))
                .is_some_and(|t| *t < time + 5e-4)
        };
        let row = |time: &f64| truth.time.partition_point(|t| *t < time - 5e-4);
        let threshold = experiment.setup.tactile.touch_force;
        Some(
            experiment
                .log
                .time
                .iter()
                .map(|time| at(time) && force[row(time)] > threshold)
                .collect(),
        )
    };
    let truth = experiment.truth.as_ref();
    let fixels = (0..experiment.setup.scene.fixels.len())
        .map(|k| by_force(truth.and_then(|truth| truth.fixel_forces.get(k))));
    std::iter::once(by_force(truth.map(|truth| &truth.pusher_force)))
        .chain(fixels)
        .collect()
}

/// One attempt of a rival, with what is drawn of its particles.
pub fn contender(
    rival: Rival,
    experiment: &Experiment,
    occlusion: Occlusion,
    rules: &Rules,
    seed: u64,
) -> Result<Contender> {
    let sample = CloudSample::new(if rival == Rival::ParticleAlwaysOn {
        0
    } else {
        DRAWN
    });
    let Attempt { run, scores } =
        rival.attempt(experiment, occlusion, rules, seed, Some(&sample))?;
    Ok(Contender {
        name: rival.title().to_owned(),
        colour: rival.colour(),
        cloud: sample.into_rows(experiment.log.len()),
        estimate: run.estimate,
        scores,
        unsolved: run.unsolved,
        saw_all: rival == Rival::ParticleAlwaysOn,
    })
}

/// Writes an episode's figures into a folder as SVG and PNG, their names after the episode's;
/// returns how many.
pub fn write_figures(folder: &Path, episode: &Episode<'_>) -> Result<usize> {
    let figures = episode.figures();
    for figure in &figures {
        write_figure(
            folder,
            &format!("{}-{}", episode.name, figure.name),
            &figure.drawing,
        )?;
    }
    Ok(figures.len())
}

/// Writes a figure into a folder as SVG and PNG.
pub fn write_figure(folder: &Path, name: &str, drawing: &Drawing) -> Result<()> {
    let svg = drawing.to_svg();
    write_file(&folder.join(format!("{name}.png")), &png_of(&svg)?)?;
    write_file(&folder.join(format!("{name}.svg")), svg.as_bytes())
}

/// Writes a report as one HTML file.
pub fn write_report(path: PathBuf, report: &Report) -> Result<PathBuf> {
    write_file(&path, report.to_html().as_bytes())?;
    Ok(path)
}

/// Writes a file; its folder is made where it is missing.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = fs::create_dir_all(path.parent().unwrap_or(Path::new("")))
        .and_then(|()| fs::write(path, bytes));
    written.map_err(|error| {
        hinted(
            format!("{}: cannot be written: {error}", path.display()),
            "give a place that can be written to",
        )
    })
}
