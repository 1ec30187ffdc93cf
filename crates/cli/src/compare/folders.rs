//! Folders that contain experiments: [`expand`], and their scenes: [`Scenes`].

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use crate::failure::hinted;
use crate::given::{is_scene, scene_file};
use crate::log_files::{is_bag, log_path};

/// Scenes of several experiments, on the command line.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Scene file in each folder
    #[arg(long, value_name = "FILE", default_value = "scene.toml")]
    scene_name: String,
    /// One scene for all logs, a file or its folder; DIR may then be a log itself
    #[arg(long, conflicts_with = "scene_name")]
    scene: Option<PathBuf>,
}

impl SceneArgs {
    /// The choice that was made.
    pub fn scenes(&self) -> Scenes<'_> {
        let one = self.scene.as_deref();
        one.map_or(Scenes::Named(&self.scene_name), Scenes::One)
    }
}

/// Choice of the scene of an experiment.
#[derive(Clone, Copy, Debug)]
pub enum Scenes<'a> {
    /// The file of this name in each folder.
    Named(&'a str),
    /// This file or the one in this folder, of all.
    One(&'a Path),
}

impl Scenes<'_> {
    /// The scene of the experiment in `folder`.
    pub fn of(self, folder: &Path) -> PathBuf {
        match self {
            Self::Named(name) => folder.join(name),
            Self::One(scene) => scene_file(scene),
        }
    }
}

/// The experiment folders among `given`: a folder that is none itself stands for those below it, in
/// the order of their names, and a scene or log for the folder whose it is. With one scene for all,
/// a log by another name is an experiment, too.
///
/// # Errors
///
/// A file that is not the scene or the log of its folder, and a second scene.
pub fn expand(given: &[PathBuf], scenes: Scenes<'_>) -> Result<Vec<PathBuf>> {
    let mut folders = Vec::new();
    for path in given {
        let folder = &if path.is_file() {
            folder_of(path, scenes)?
        } else {
            path.clone()
        };
        // a scene and its log stand for one experiment
        if path.is_file() && folders.last() == Some(folder) {
            continue;
        }
        let below = if folder.is_file() || is_experiment(folder, scenes) {
            Vec::new()
        } else {
            experiments_below(folder, scenes)
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

/// The files of experiments: their logs and scenes.
pub fn inputs(folders: &[PathBuf], scenes: Scenes<'_>) -> Vec<PathBuf> {
    let of = |folder: &PathBuf| [log_path(folder), scenes.of(folder)];
    folders.iter().flat_map(of).collect()
}

/// The experiment that a file is the scene or the log of.
fn folder_of(file: &Path, scenes: Scenes<'_>) -> Result<PathBuf> {
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let is = |own: &Path| own.file_name() == file.file_name();
    match scenes {
        _ if is(&log_path(folder)) => Ok(folder.to_owned()),
        Scenes::Named(name) if is(Path::new(name)) => Ok(folder.to_owned()),
        Scenes::Named(name) => Err(stray_file(file, name)),
        Scenes::One(scene) if is_scene(file) => Err(hinted(
            format!(
                "{} and {}: these are two scenes",
                file.display(),
                scene.display()
            ),
            "leave one out",
        )),
        Scenes::One(_) => Ok(file.to_owned()),
    }
}

/// The error about a file that no folder has for its log or scene.
fn stray_file(file: &Path, scene_name: &str) -> anyhow::Error {
    let shown = file.display();
    let help = match is_scene(file) {
        true => format!("give such a folder, or this scene for all: DIR --scene {shown}"),
        false => format!("give such a folder, or its scene, too: {shown} --scene SCENE"),
    };
    hinted(
        format!(
            "{shown}: a file; experiments are given as folders with {scene_name} and log.csv, log.mcap or a bag"
        ),
        help,
    )
}

/// A folder with a log or a scene of its own means to be an experiment, even if the other is
/// missing.
pub fn is_experiment(folder: &Path, scenes: Scenes<'_>) -> bool {
    let scene = matches!(scenes, Scenes::Named(name) if folder.join(name).is_file());
    scene || is_bag(folder) || log_path(folder).is_file()
}

fn experiments_below(folder: &Path, scenes: Scenes<'_>) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut below: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.is_dir())
        .collect();
    below.sort();
    let expanded = below.into_iter().flat_map(|path| {
        if is_experiment(&path, scenes) {
            vec![path]
        } else {
            experiments_below(&path, scenes)
        }
    });
    expanded.collect()
}
