//! `stickslip compare`: every variant on each experiment folder, medians over seeds, quantiles over
//! folders.

mod best_baseline;
mod figures;
mod folder_set;
mod folders;
mod page;
mod played;
mod results;
mod tables;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use anyhow::{Result, anyhow};
use clap::CommandFactory;
use rayon::prelude::*;
use stickslip::{FilterModel, Occlusion, Tracking};
use stickslip_evaluation::{RunConditions, ScoredRun, Variant};
use stickslip_formats::{BagOptions, Experiment};
use stickslip_report::Report;

use crate::args::{CompareArgs, Program};
use crate::experiment::{check_occlusion, check_sense, read_folder};
use crate::files::{ready_file, write_report};
use crate::output::{show, talk};
use crate::progress::{Work, bar};
use crate::verdict::Verdict;
pub use folders::{SceneArgs, Scenes, expand, inputs, is_experiment};
pub use results::{ComparedRun, ShownScores};
use results::{Comparison, FolderResult, LostFolder};

/// Runs above which a person would wait.
const MANY: usize = 8;

/// An experiment folder with its hidden rows.
pub struct Folder {
    /// Its path.
    pub path: PathBuf,
    /// Its content.
    pub experiment: Experiment,
    /// Hidden rows.
    pub occlusion: Occlusion,
    /// Tracking of the pusher.
    pub tracking: Tracking,
}

/// One run that is to be made.
#[derive(Clone, Copy)]
struct Job {
    /// Index of the folder.
    folder: usize,
    variant: Variant,
    seed: u64,
}

/// Runs the command.
pub fn compare(args: &CompareArgs) -> Result<Verdict> {
    let scenes = args.scenes.scenes();
    let folders = expand(&args.folders, scenes)?;
    if let Some(path) = &args.report {
        let inputs = inputs(&folders, scenes);
        ready_file(
            path,
            &inputs.iter().map(PathBuf::as_path).collect::<Vec<_>>(),
        )?;
    }
    let pool = args.shared.threads.pool()?;
    let topics = args.topics.options(Program::command())?;
    let (comparison, folders, verdict) =
        pool.install(|| compare_all(args, (scenes, &topics), folders));
    let text = if args.shared.json {
        serde_json::to_string_pretty(&comparison)?
    } else {
        tables::text(&comparison)
    };
    if !text.is_empty() {
        show(text)?;
    }
    if let Some(path) = &args.report {
        let played =
            pool.install(|| played::played(&comparison, args.shared.model.into(), &folders))?;
        let path = write_report(path.clone(), &page::report(&comparison, played))?;
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

/// The page about runs that a caller made on these folders.
pub fn page_of(
    runs: &[ComparedRun],
    particles: usize,
    model: FilterModel,
    folders: &[Folder],
) -> Result<Report> {
    let comparison = Comparison::of_runs(runs, particles);
    let played = played::played(&comparison, model, folders)?;
    Ok(page::report(&comparison, played))
}

/// The comparison, the folders that could be read, and whether all of the logs in them could be.
fn compare_all(
    args: &CompareArgs,
    given: (Scenes<'_>, &BagOptions),
    paths: Vec<PathBuf>,
) -> (Comparison, Vec<Folder>, Verdict) {
    // read all folders; those that cannot be read are reported and left out
    let read: Vec<Result<(Folder, Verdict), LostFolder>> = paths
        .into_par_iter()
        .map(|path| read(args, given, path))
        .collect();
    let mut errors = Vec::new();
    let (folders, verdicts): (Vec<Folder>, Vec<Verdict>) = read
        .into_iter()
        .filter_map(|folder| folder.map_err(|lost| errors.push(lost)).ok())
        .unzip();

    // run every variant with every seed on each
    let jobs = jobs(&folders, args.seeds);
    let work = if jobs.len() > MANY {
        Work::Long
    } else {
        Work::Short
    };
    let progress = bar(jobs.len(), "runs", work);
    let run = |job: &Job| {
        let scores = run(args, &folders[job.folder], *job);
        progress.inc(1);
        scores
    };
    let scores: Vec<Result<ShownScores>> = jobs.par_iter().map(run).collect();
    progress.finish_and_clear();

    // gather them by folder; one failed run loses its folder
    let mut results = Vec::new();
    for (index, folder) in folders.iter().enumerate() {
        let all = jobs.iter().zip(&scores);
        let own = all.filter(|(job, _)| job.folder == index);
        let own = own.map(|(job, scores)| (job.variant, scores));
        match FolderResult::gather(&folder.path, &folder.experiment, own) {
            Ok(result) => results.push(result),
            Err(error) => errors.push(LostFolder::new(&folder.path, error)),
        }
    }
    let mut verdicts = verdicts.into_iter();
    let cut_off = verdicts.find(|verdict| *verdict != Verdict::Done);
    let comparison = Comparison::new((args.shared.particles, args.seeds), results, errors);
    (comparison, folders, cut_off.unwrap_or(Verdict::Done))
}

/// Reads a folder; the options say which rows are hidden, else truth.json does. The verdict says
/// whether all of the log could be read.
fn read(
    args: &CompareArgs,
    (scenes, topics): (Scenes<'_>, &BagOptions),
    path: PathBuf,
) -> Result<(Folder, Verdict), LostFolder> {
    let (experiment, verdict) = read_folder(&path, &scenes.of(&path), topics)
        .map_err(|error| LostFolder::new(&path, &error))?;
    let occlusion = match args.shared.occlusion() {
        Occlusion::None => experiment.facts.occlusion(),
        asked => asked,
    };
    check_occlusion(occlusion, &experiment.log)
        .and_then(|()| check_sense(&args.shared.force, &experiment))
        .map_err(|error| LostFolder::new(&path, &error))?;
    let tracking = args.shared.tracking();
    let folder = Folder {
        path,
        experiment,
        occlusion,
        tracking,
    };
    Ok((folder, verdict))
}

fn jobs(folders: &[Folder], seeds: u64) -> Vec<Job> {
    let mut jobs = Vec::new();
    for (folder, read) in folders.iter().enumerate() {
        for variant in Variant::compared_on(&read.experiment.log, read.occlusion) {
            let seeds = if variant.is_random() { seeds } else { 1 };
            jobs.extend((0..seeds).map(|seed| Job {
                folder,
                variant,
                seed,
            }));
        }
    }
    jobs
}

/// Runs one job; a panic in it is an error of its folder.
fn run(args: &CompareArgs, folder: &Folder, job: Job) -> Result<ShownScores> {
    let conditions = RunConditions {
        model: args.shared.model.into(),
        particles: args.shared.particles,
        tracking: folder.tracking,
        occlusion: folder.occlusion,
        seed: job.seed,
    };
    let run = catch_unwind(AssertUnwindSafe(|| {
        ScoredRun::new(job.variant, &folder.experiment, &conditions, None)
    }));
    let run = run.map_err(|_| {
        anyhow!(
            "{} with seed {} broke an invariant of the library (see above)",
            job.variant.name(),
            job.seed
        )
    })??;
    Ok(ShownScores::of(&run))
}
