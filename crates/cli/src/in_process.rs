//! Files of logs for callers in this process, with what the program would write to standard error:
//! [`read_log_at`], [`bag_info`], [`log_files`], [`check_occlusion`],
//! [`check_sense`].

use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip::{Log, Occlusion, Setup};
use stickslip_formats::{BagOptions, LogWarning};

use crate::experiment;
use crate::failure::{Hinted, one_line};
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
