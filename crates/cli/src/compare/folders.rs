//! Which folders hold experiments: [`expand`].

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;

use crate::failure::hinted;
use crate::log_files::{is_bag, log_path};

/// The experiment folders among `given`: a folder that is none itself stands for those below it, in
/// the order of their names, and a scene or log for the folder whose it is.
///
/// # Errors
///
/// A file that is not the scene or the log of its folder.
pub fn expand(given: &[PathBuf], scene_name: &str) -> Result<Vec<PathBuf>> {
    let mut folders = Vec::new();
    for path in given {
        let folder = &if path.is_file() {
            folder_of(path, scene_name)?
        } else {
            path.clone()
        };
        // a scene and its log stand for one experiment
        if path.is_file() && folders.last() == Some(folder) {
            continue;
        }
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

/// The experiment folder that a file is the scene or the log of.
fn folder_of(file: &Path, scene_name: &str) -> Result<PathBuf> {
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let own = [folder.join(scene_name), log_path(folder)];
    match own.iter().any(|path| path.file_name() == file.file_name()) {
        true => Ok(folder.to_owned()),
        false => Err(hinted(
            format!(
                "{}: a file; experiments are given as folders with {scene_name} and log.csv, log.mcap or a bag",
                file.display()
            ),
            format!(
                "give such a folder, or filter this log alone: `stickslip filter {} --scene SCENE`",
                file.display()
            ),
        )),
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
