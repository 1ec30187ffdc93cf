//! `stickslip reproduce`: the paper's tables and figures, ours beside the paper's numbers.

mod course;
mod figures;
mod footage;
mod noise;
mod page;
mod participant;
mod published;
mod recording;
mod results;
mod standing;
mod still;
mod text;

use std::fs;
use std::path::Path;

use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use stickslip::Tracking;
use stickslip_rendering::Optics;

use crate::args::ReproduceArgs;
use crate::contest::Rules;
use crate::episode::{write_figure, write_file, write_report};
use crate::failure::hinted;
use crate::output::{show, talk};
use crate::paper::PaperExperiment;
use crate::progress::{Work, bar};
use crate::verdict::Verdict;
use course::{Course, Heat, participants};
use figures::figures;
use footage::{Footage, Tracked};
use noise::{Noise, NoiseLevel};
use page::page;
use participant::Participant;
use recording::Recording;
use results::{Ratio, Reproduction};

/// Seeds where the command line does not say.
const SEEDS: u64 = 20;

/// All that the command says.
#[derive(Debug, Serialize)]
struct Report {
    particles: usize,
    seeds: u64,
    /// The tables; from frames where [`Report::equal`] is there.
    #[serde(flatten)]
    tables: Reproduction,
    equal: Option<Equal>,
}

/// What frames are compared with.
#[derive(Debug, Serialize)]
struct Equal {
    /// Noise of the tracked poses, which is that of the simulated ones, by experiment.
    noise: Vec<NoiseLevel>,
    /// The tables from simulated poses.
    from_poses: Reproduction,
    /// Medians from frames over those from poses.
    ratios: Vec<Ratio>,
}

/// Runs the command.
pub fn reproduce(args: &ReproduceArgs) -> Result<Verdict> {
    if let Some(folder) = &args.out {
        make(folder)?;
    }
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let rules = Rules {
        particles: args.particles,
        tracking: Tracking::Smoothed,
    };
    let report = pool.install(|| report(args, &rules))?;
    show(if args.json {
        serde_json::to_string_pretty(&report)?
    } else {
        report.text()
    })?;
    Ok(Verdict::Done)
}

fn report(args: &ReproduceArgs, rules: &Rules) -> Result<Report> {
    let seeds = args.seeds.unwrap_or(SEEDS);
    let recordings = recordings(seeds)?;
    let (heats, equal) = if args.from_frames {
        let (tracked, simulated, noise) = filmed(&recordings)?;
        let (tracked, simulated) = (heats(tracked, rules)?, heats(simulated, rules)?);
        let from_poses = Reproduction::new(&simulated);
        let ratios = Ratio::all(&Reproduction::new(&tracked), &from_poses);
        (
            tracked,
            Some(Equal {
                noise,
                from_poses,
                ratios,
            }),
        )
    } else {
        (heats(recordings, rules)?, None)
    };
    let report = Report {
        particles: args.particles,
        seeds,
        tables: Reproduction::new(&heats),
        equal,
    };
    if let Some(folder) = &args.out {
        write(folder, &report, &heats, rules)?;
    }
    Ok(report)
}

impl Report {
    fn text(&self) -> String {
        let tables = text::text(&self.tables);
        match &self.equal {
            None => tables,
            Some(Equal {
                noise,
                from_poses,
                ratios,
            }) => {
                format!(
                    "From frames\n\n{tables}\nFrom simulated poses of equal noise\n\n{}\n{}\n{}",
                    text::text(from_poses),
                    text::noise(noise),
                    text::ratios(ratios)
                )
            }
        }
    }
}

/// Makes the folder for results before minutes are spent on them.
fn make(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| {
        hinted(
            format!("{}: cannot be made: {error}", folder.display()),
            "give a folder that can be written to with --out",
        )
    })
}

/// Writes reproduce.json, the figures and report.html.
fn write(folder: &Path, report: &Report, heats: &[Heat], rules: &Rules) -> Result<()> {
    let figures = figures(heats)?;
    figures
        .par_iter()
        .try_for_each(|figure| write_figure(folder, figure.name, &figure.drawing))?;
    write_file(
        &folder.join("reproduce.json"),
        serde_json::to_string_pretty(report)?.as_bytes(),
    )?;
    let page = write_report(
        folder.join("report.html"),
        &page(&report.tables, heats, &figures, rules)?,
    )?;
    talk(format_args!(
        "wrote {} figures as SVG and PNG, reproduce.json and {}",
        figures.len(),
        page.display()
    ));
    Ok(())
}

/// Every experiment with every seed, simulated.
fn recordings(seeds: u64) -> Result<Vec<Recording>> {
    let all: Vec<(PaperExperiment, u64)> = PaperExperiment::ALL
        .into_iter()
        .flat_map(|paper| (0..seeds).map(move |seed| (paper, seed)))
        .collect();
    let progress = bar(all.len(), "experiments simulated", Work::Long);
    let simulated = |(paper, seed): (PaperExperiment, u64)| {
        let recording = Recording::simulate(paper, seed);
        progress.inc(1);
        recording
    };
    let recordings = all.into_par_iter().map(simulated).collect();
    progress.finish_and_clear();
    recordings
}

/// The recordings from frames, the same from simulated poses of equal noise, and that noise by
/// experiment.
fn filmed(recordings: &[Recording]) -> Result<(Vec<Recording>, Vec<Recording>, Vec<NoiseLevel>)> {
    let frames: usize = recordings
        .iter()
        .map(|recording| recording.experiment.log.len())
        .sum();
    let progress = bar(frames, "frames", Work::Long);
    let (mut tracked, mut simulated, mut levels) = (Vec::new(), Vec::new(), Vec::new());
    for paper in PaperExperiment::ALL {
        let own: Vec<&Recording> = recordings
            .iter()
            .filter(|recording| recording.paper == paper)
            .collect();
        let footage = Footage::new(&own, Optics::default())?;
        let seen: Vec<Tracked> = own
            .par_iter()
            .map(|recording| footage.track(recording, &progress))
            .collect::<Result<_>>()?;
        let noise = seen
            .iter()
            .fold(Noise::default(), |sum, tracked| sum.with(tracked.noise));
        levels.push(noise.level());
        simulated.extend(
            seen.par_iter()
                .map(|seen| seen.recording.with_noise(&noise))
                .collect::<Result<Vec<_>>>()?,
        );
        tracked.extend(
            seen.into_iter()
                .map(|tracked| tracked.recording.told(noise.told())),
        );
    }
    progress.finish_and_clear();
    Ok((tracked, simulated, levels))
}

/// Every participant on every recording.
fn heats(recordings: Vec<Recording>, rules: &Rules) -> Result<Vec<Heat>> {
    let jobs: Vec<(&Recording, Participant)> = recordings
        .iter()
        .flat_map(|recording| {
            participants(recording.paper)
                .into_iter()
                .map(move |participant| (recording, participant))
        })
        .collect();
    let progress = bar(jobs.len(), "runs", Work::Long);
    let run = |(recording, participant): &(&Recording, Participant)| {
        let course = Course::run(*participant, recording, rules);
        progress.inc(1);
        course
    };
    let courses: Vec<Course> = jobs.par_iter().map(run).collect::<Result<_>>()?;
    progress.finish_and_clear();
    let mut courses = courses.into_iter();
    let heat = |recording: Recording| {
        let courses = courses
            .by_ref()
            .take(participants(recording.paper).len())
            .collect();
        Heat { recording, courses }
    };
    Ok(recordings.into_iter().map(heat).collect())
}
