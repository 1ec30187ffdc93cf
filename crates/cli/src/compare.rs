//! `stickslip compare`: every method on each experiment folder, medians over seeds, quantiles over
//! folders.

mod folders;
mod page;
pub mod results;
pub mod tables;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use anyhow::{Result, anyhow};
use rayon::prelude::*;
use stickslip::Occlusion;
use stickslip_formats::Experiment;

use crate::args::{CompareArgs, SharedArgs};
use crate::contest::{Rival, Rules};
use crate::episode::write_report;
use crate::experiment::read_folder;
use crate::output::{show, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;
use results::{Comparison, FolderResult, LostFolder, Marks};

/// An experiment with what is hidden in it.
struct Case {
    folder: PathBuf,
    experiment: Experiment,
    occlusion: Occlusion,
    /// Whether all of the log could be read.
    verdict: Verdict,
}

/// One run that is to be made.
#[derive(Clone, Copy)]
struct Job {
    case: usize,
    rival: Rival,
    seed: u64,
}

/// Runs the command.
pub fn compare(args: &CompareArgs) -> Result<Verdict> {
    let folders = folders::expand(&args.folders, &args.scene_name)?;
    let (comparison, verdict) = args.shared.pool()?.install(|| compare_all(args, folders));
    let text = if args.shared.json {
        serde_json::to_string_pretty(&comparison)?
    } else {
        tables::text(&comparison)
    };
    if !text.is_empty() {
        show(text)?;
    }
    if let Some(path) = &args.report {
        let path = write_report(path.clone(), &page::report(&comparison))?;
        talk(format_args!("wrote {}", path.display()));
    }
    for lost in &comparison.errors {
        talk(format_args!("error: {}", lost.error));
    }
    Ok(
        match (comparison.folders.is_empty(), comparison.errors.is_empty()) {
            (true, _) => Verdict::Failed,
            (false, true) => verdict,
            (false, false) => Verdict::InputLost,
        },
    )
}

/// The comparison, and whether all of the logs in it could be read.
fn compare_all(args: &CompareArgs, folders: Vec<PathBuf>) -> (Comparison, Verdict) {
    // read all folders; those that cannot be read are reported and left out
    let read: Vec<Result<Case, LostFolder>> = folders
        .into_par_iter()
        .map(|folder| read_case(args, folder))
        .collect();
    let mut errors = Vec::new();
    let cases: Vec<Case> = read
        .into_iter()
        .filter_map(|case| case.map_err(|lost| errors.push(lost)).ok())
        .collect();

    // run every rival with every seed on each
    let jobs = jobs(&cases, args.seeds);
    let progress = bar(
        jobs.len(),
        "runs",
        if jobs.len() > 8 {
            Work::Long
        } else {
            Work::Short
        },
    );
    let rules = Rules {
        particles: args.shared.particles,
        tracking: args.shared.tracking(),
    };
    let counted = |job: &Job| {
        let marks = marks(&cases, *job, &rules);
        progress.inc(1);
        marks
    };
    let marks: Vec<Result<Marks>> = jobs.par_iter().map(counted).collect();
    progress.finish_and_clear();

    // gather them by folder; one failed run loses its folder
    let mut results = Vec::new();
    for (index, case) in cases.iter().enumerate() {
        let own = jobs
            .iter()
            .zip(&marks)
            .filter(|(job, _)| job.case == index)
            .map(|(job, marks)| (job.rival, marks));
        match FolderResult::gather(&case.folder, own) {
            Ok(result) => results.push(result),
            Err(error) => errors.push(LostFolder::new(&case.folder, error)),
        }
    }
    let cut_off = cases.iter().find(|case| case.verdict != Verdict::Done);
    (
        Comparison::new(args, results, errors),
        cut_off.map_or(Verdict::Done, |case| case.verdict),
    )
}

fn read_case(args: &CompareArgs, folder: PathBuf) -> Result<Case, LostFolder> {
    let read = || -> Result<Case> {
        let (experiment, verdict) = read_folder(&folder, &args.scene_name)?;
        let occlusion = occlusion(&experiment, &args.shared);
        Ok(Case {
            folder: folder.clone(),
            experiment,
            occlusion,
            verdict,
        })
    };
    read().map_err(|error| LostFolder::new(&folder, &error))
}

/// What truth.json says is hidden, else what the options say.
fn occlusion(experiment: &Experiment, options: &SharedArgs) -> Occlusion {
    match experiment.facts.occlude_from {
        Some(from) => Occlusion::Rows { from, to: None },
        None => options.occlusion(),
    }
}

fn jobs(cases: &[Case], seeds: u64) -> Vec<Job> {
    let rivals = cases.iter().enumerate().flat_map(|(case, c)| {
        Rival::on(&c.experiment, c.occlusion)
            .into_iter()
            .map(move |rival| (case, rival))
    });
    rivals
        .flat_map(|(case, rival)| {
            (0..if rival.is_random() { seeds } else { 1 }).map(move |seed| Job {
                case,
                rival,
                seed,
            })
        })
        .collect()
}

/// Runs one job; a panic in it is an error of its folder.
fn marks(cases: &[Case], job: Job, rules: &Rules) -> Result<Marks> {
    let case = &cases[job.case];
    let attempt = catch_unwind(AssertUnwindSafe(|| {
        job.rival
            .attempt(&case.experiment, case.occlusion, rules, job.seed, None)
    }));
    let attempt = attempt.map_err(|_| {
        anyhow!(
            "{} with seed {} broke an invariant of the library (see above)",
            job.rival.name(),
            job.seed
        )
    })??;
    Ok(Marks::new(&attempt.scores, attempt.run.unsolved))
}
