//! Which log is meant, and which scene: [`GivenArgs`].

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use crate::experiment::scene_beside;
use crate::failure::hinted;
use crate::log_files::log_path;

/// A log and a scene, in any of the ways that they are given.
#[derive(Debug, Args)]
pub struct GivenArgs {
    /// Recorded experiment: log.csv, an MCAP file, a bag's folder, or a folder with one of these
    #[arg(value_name = "LOG")]
    first: PathBuf,
    /// Scene, before or after LOG [default: scene.toml in the log's folder or next to it]
    #[arg(value_name = "SCENE.toml")]
    second: Option<PathBuf>,
    /// Scene under any name, or a folder with scene.toml
    #[arg(long)]
    scene: Option<PathBuf>,
}

/// A log and its scene.
#[derive(Debug, PartialEq, Eq)]
pub struct Given {
    /// A file or a folder.
    pub log: PathBuf,
    /// A file.
    pub scene: PathBuf,
}

impl GivenArgs {
    /// The log and the scene that are meant; `command` is the program's command that was given it.
    ///
    /// # Errors
    ///
    /// Two scenes, two logs, or one without the other.
    pub fn resolve(&self, command: &str) -> Result<Given> {
        let first = &self.first;
        match (&self.second, &self.scene) {
            (None, Some(scene)) if is_scene(first) => Err(two_scenes(first, scene, command)),
            (None, Some(scene)) => Ok(Given::of(first, scene_file(scene))),
            (None, None) if is_scene(first) => log_beside(first, command),
            (None, None) => Ok(Given::of(first, scene_beside(first)?)),
            (Some(second), Some(scene)) => {
                let other = if is_scene(first) { first } else { second };
                Err(match is_scene(other) {
                    true => two_scenes(other, scene, command),
                    false => two_logs(first, second, command),
                })
            }
            (Some(second), None) => match (is_scene(first), is_scene(second)) {
                (true, false) => Ok(Given::of(second, first.clone())),
                (false, true) => Ok(Given::of(first, second.clone())),
                (true, true) => Err(two_scenes(first, second, command)),
                (false, false) => Err(two_logs(first, second, command)),
            },
        }
    }
}

impl Given {
    fn of(log: &Path, scene: PathBuf) -> Self {
        Self {
            log: log.to_owned(),
            scene,
        }
    }
}

/// A scene's file, where its folder may be given.
pub fn scene_file(given: &Path) -> PathBuf {
    match given.is_dir() {
        true => given.join("scene.toml"),
        false => given.to_owned(),
    }
}

/// True if a path is a scene by its name.
pub fn is_scene(path: &Path) -> bool {
    let toml = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("toml"));
    toml && !path.is_dir()
}

/// A scene that is given alone stands for the log next to it.
fn log_beside(scene: &Path, command: &str) -> Result<Given> {
    let folder = match scene.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let log = log_path(folder);
    match log.exists() {
        true => Ok(Given::of(&log, scene.to_owned())),
        false => Err(hinted(
            format!(
                "{}: this is a scene, and there is no log next to it",
                scene.display()
            ),
            format!(
                "give the log, too: `stickslip {command} LOG --scene {}`",
                scene.display()
            ),
        )),
    }
}

/// The error about two scenes for one log.
fn two_scenes(first: &Path, second: &Path, command: &str) -> anyhow::Error {
    hinted(
        format!(
            "{} and {}: these are two scenes",
            first.display(),
            second.display()
        ),
        format!(
            "give one log and one scene: `stickslip {command} LOG --scene {}`",
            second.display()
        ),
    )
}

fn two_logs(first: &Path, second: &Path, command: &str) -> anyhow::Error {
    hinted(
        format!(
            "{} and {}: neither is a scene, whose name ends in .toml",
            first.display(),
            second.display()
        ),
        format!(
            "give one log at a time: `stickslip {command} {}`; a scene by another name comes after --scene; \
             `stickslip compare` takes many folders",
            first.display()
        ),
    )
}
