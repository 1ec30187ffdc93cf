//! Services of the program for callers in this process: files of logs, with what the program would
//! write to standard error ([`read_log_at`], [`bag_info`], [`log_files`], [`check_occlusion`],
//! [`check_sense`]), and its pages ([`run_page`], [`run_player`], [`comparison_page`],
//! [`fit_page`]).

use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip::{FilterModel, Log, Occlusion, Setup};
use stickslip_evaluation::{ScoredRun, Variant};
use stickslip_fit::{CrossValidation, Fit, Push};
use stickslip_formats::{BagOptions, Experiment, LogWarning};
use stickslip_report::{Report, ReportedExperiment, ReportedRun};

use crate::compare;
pub use crate::compare::{ComparedRun, Folder as ComparedFolder, ShownScores};
use crate::experiment;
use crate::failure::{Hinted, one_line};
use crate::filter;
use crate::fit;
use crate::info::Shown;
use crate::log_files::{LogFiles, topic_hint};

/// Reads the log at a path, and its warnings. The path is a table, an MCAP recording, the folder
/// of a bag, or an experiment folder.
///
/// # Errors
/// The log cannot be found or read; in words, with the next step.
pub fn read_log_at(path: &Path, options: &BagOptions) -> Result<(Log, Vec<String>), String> {
    let option = |key: &str, topic: &str| format!("topics={{\"{key}\": \"{topic}\"}}");
    at(path, |files| {
        let read = files.read_quietly(options);
        read.map_err(|error| topic_hint(error, option))
    })
}

/// Describes the bag at a path, as `stickslip info --json`, and its warnings.
///
/// # Errors
/// There is no bag, or it cannot be read; in words, with the next step.
pub fn bag_info(path: &Path) -> Result<(String, Vec<String>), String> {
    at(path, |files| {
        let (info, warnings) = files.info()?;
        Ok((serde_json::to_string(&Shown::new(path, info))?, warnings))
    })
}

/// Finds the files of the log at a path.
///
/// # Errors
/// A bag without files, or of another kind than MCAP; in words, with the next step.
pub fn log_files(path: &Path) -> Result<Vec<PathBuf>, String> {
    LogFiles::find(path)
        .map(|files| files.paths)
        .map_err(|error| words(&error))
}

/// Refuses an occlusion that hides none or all of a log's object poses.
///
/// # Errors
/// The occlusion is refused; in words, with the next step.
pub fn check_occlusion(occlusion: Occlusion, log: &Log) -> Result<(), String> {
    experiment::check_occlusion(occlusion, log).map_err(|error| words(&error))
}

/// Refuses a log whose units, frames or columns are found to be wrong.
///
/// # Errors
/// The log is refused; in words, with the next step.
pub fn check_sense(setup: &Setup, log: &Log) -> Result<(), String> {
    experiment::refuse_nonsense(setup, log, "force=True").map_err(|error| words(&error))
}

/// The page of `stickslip filter --report` about a run. `origin`: name and value of what it was
/// made of.
pub fn run_page(
    name: &str,
    experiment: &Experiment,
    (run, occlusion): (ReportedRun, Occlusion),
    warnings: &[String],
    origin: Vec<(String, String)>,
) -> String {
    let page = filter::page(name, experiment, (run, occlusion), warnings);
    let report = Report {
        origin: origin.into_iter().chain(page.origin).collect(),
        ..page
    };
    report.to_html()
}

/// A page that plays a run back and shows nothing else.
pub fn run_player(experiment: &Experiment, scored: ScoredRun, occlusion: Occlusion) -> String {
    let title = scored.variant.title();
    let run = ReportedRun {
        scored,
        cloud: Vec::new(),
    };
    let reported = ReportedExperiment::new(title, "", experiment, occlusion, vec![run]);
    Report::player(reported.playback()).to_html()
}

/// The page of `stickslip compare --report` about runs on these folders, whose players it makes.
///
/// # Errors
/// A run fails; in words.
pub fn comparison_page(
    runs: &[ComparedRun],
    particles: usize,
    model: FilterModel,
    folders: &[ComparedFolder],
) -> Result<String, String> {
    let page = compare::page_of(runs, particles, model, folders);
    page.map(|page| page.to_html())
        .map_err(|error| words(&error))
}

/// The page of `stickslip fit --report` about a fit to `pushes`.
pub fn fit_page(
    pushes: &[Push],
    fit: &Fit,
    cross_validation: Option<&CrossValidation>,
    warnings: &[String],
    seed: u64,
) -> String {
    fit::page_of(pushes, fit, cross_validation, warnings, seed).to_html()
}

/// The compared method of a name, as in the JSON of `stickslip compare`.
#[must_use]
pub fn compared_method(key: &str) -> Option<Variant> {
    let mut all = Variant::COMPARED.into_iter();
    all.find(|variant| variant.key() == key)
}

fn at<T>(
    path: &Path,
    read: impl FnOnce(&LogFiles) -> Result<(T, Vec<LogWarning>)>,
) -> Result<(T, Vec<String>), String> {
    let read = || {
        let files = LogFiles::find(path)?;
        let (found, warnings) = read(&files)?;
        Ok((found, files.warnings(&warnings)))
    };
    read().map_err(|error: anyhow::Error| words(&error))
}

/// An error and the next step in one line.
fn words(error: &anyhow::Error) -> String {
    let message = one_line(error);
    match error.downcast_ref::<Hinted>() {
        Some(hinted) => format!("{message}; {}", hinted.help),
        None => message,
    }
}
