//! `stickslip reproduce`: the paper's tables and figures, ours beside the paper's numbers.

mod participant;
mod course;
mod published;
mod reasons;
mod recording;
mod results;
mod standing;
mod text;

use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use stickslip::Tracking;

use crate::args::ReproduceArgs;
use crate::contest::Rules;
use crate::output::show;
use crate::paper::PaperExperiment;
use crate::progress::{Work, bar};
use crate::verdict::Verdict;
use participant::Participant;
use course::{Course, Heat, participants};
use recording::Recording;
use results::Reproduction;

/// All that the command says.
#[derive(Debug, Serialize)]
struct Report {
    particles: usize,
    seeds: u64,
    from_poses: Reproduction,
}

/// Runs the command.
pub fn reproduce(args: &ReproduceArgs) -> Result<Verdict> {
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let rules = Rules { particles: args.particles, tracking: Tracking::Smoothed };
    let heats = pool.install(|| heats(recordings(args.seeds)?, &rules))?;
    let report = Report { particles: args.particles, seeds: args.seeds, from_poses: Reproduction::new(&heats) };
    show(if args.json { serde_json::to_string_pretty(&report)? } else { text::text(&report.from_poses) })?;
    Ok(Verdict::Done)
}

/// Every experiment with every seed, simulated.
fn recordings(seeds: u64) -> Result<Vec<Recording>> {
    let all: Vec<(PaperExperiment, u64)> =
        PaperExperiment::ALL.into_iter().flat_map(|paper| (0..seeds).map(move |seed| (paper, seed))).collect();
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

/// Every participant on every recording.
fn heats(recordings: Vec<Recording>, rules: &Rules) -> Result<Vec<Heat>> {
    let jobs: Vec<(&Recording, Participant)> = recordings
        .iter()
        .flat_map(|recording| participants(recording.paper).into_iter().map(move |participant| (recording, participant)))
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
        let courses = courses.by_ref().take(participants(recording.paper).len()).collect();
        Heat { recording, courses }
    };
    Ok(recordings.into_iter().map(heat).collect())
}
