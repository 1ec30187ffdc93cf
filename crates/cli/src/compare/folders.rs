//! Which folders hold experiments: [`expand`].

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::failure::hinted;
use crate::log_files::{is_bag, log_path};

/// The experiment folders among `given`: a folder that is none itself stands for those below it, in
/// the order of their names.
pub fn expand(given: &[PathBuf], scene_name: &str) -> Result<Vec<PathBuf>> {
    let mut folders = Vec::new();
    for folder in given {
        let below = if is_experiment(folder, scene_name) {
            Vec::new()
        } else {
            experiments_below(folder, scene_name)
        };
        // a folder without any is kept: its error is reported with the others'
        if below.is_empty() {
            folders.push(folder.clone())
        } else {
            folders.extend(below)
        }
    }
    match folders.is_empty() {
        true => Err(hinted(
            "no experiment folder was given",
            "give folders with scene.toml and log.csv or log.mcap",
        )),
        false => Ok(folders),
    }
}

/// A folder with a log or a scene means to be an experiment, even if the other is missing.
fn is_experiment(folder: &Path, scene_name: &str) -> bool {
    folder.join(scene_name).is_file() || is_bag(folder) || log_path(folder).is_file()
}

fn experiments_below(folder: &Path, scene_name: &str) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut below: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.is_dir())
        .collect();
    below.sort();
    let expanded = below.into_iter().flat_map(|path| {
        if is_experiment(&path, scene_name) {
            vec![path]
        } else {
            experiments_below(&path, scene_name)
        }
    });
    expanded.collect()
}
