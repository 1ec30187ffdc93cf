//! Recorded experiments with their hidden rows: [`RecordedCase`]s, read from a folder by
//! [`recorded_cases`].

use std::fs;
use std::path::{Path, PathBuf};

use stickslip::{Log, Occlusion, Setup};
use stickslip_formats::{TruthFacts, read_log, read_scene, read_truth_json};

/// Length of the occlusion about the middle of a log that names no other (s).
const OCCLUSION: f64 = 1.0;

/// One recorded experiment, one scene file of it, one occlusion.
#[derive(Clone, Debug)]
pub struct RecordedCase {
    /// The experiment's folder.
    pub folder: PathBuf,
    /// Name of the scene file.
    pub scene_name: String,
    /// The scene.
    pub setup: Setup,
    /// The log.
    pub log: Log,
    /// Rows that are hidden.
    pub occlusion: Occlusion,
}

/// Reason why an experiment could not be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordedError {
    /// A file or folder cannot be read.
    #[error("{path}: {cause}; give folders of experiments, each with scene.toml and log.csv")]
    File {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        cause: std::io::Error,
    },
    /// A file does not have the right content.
    #[error(transparent)]
    Content(Box<dyn std::error::Error + Send + Sync>),
    /// No folder holds an experiment.
    #[error(
        "{path}: no log.csv in it or below; give folders of experiments, each with scene.toml and log.csv"
    )]
    Empty {
        /// The folder searched.
        path: PathBuf,
    },
}

/// Every experiment below `root`, in the order of their paths: with each scene file (`scene.toml`,
/// `scene-*.toml`), once with all of the camera and once with it hidden, from the row that
/// `truth.json` names on, else for the middle second. A log without a pose in that second comes
/// once.
///
/// # Errors
/// There is none, or a file of one cannot be read.
pub fn recorded_cases(root: &Path) -> Result<Vec<RecordedCase>, RecordedError> {
    let mut cases = Vec::new();
    for folder in folders_with_log(root)? {
        let facts = truth_facts(&folder)?;
        let (log, _) = read_log(
            text(&folder.join("log.csv"))?.as_bytes(),
            &shown(&folder.join("log.csv")),
        )
        .map_err(content)?;
        for scene_name in scene_names(&folder)? {
            let path = folder.join(&scene_name);
            let setup = read_scene(&text(&path)?, &shown(&path)).map_err(content)?;
            cases.extend(
                occlusions(&facts, &log)
                    .into_iter()
                    .map(|occlusion| RecordedCase {
                        folder: folder.clone(),
                        scene_name: scene_name.clone(),
                        setup: setup.clone(),
                        log: log.clone(),
                        occlusion,
                    }),
            );
        }
    }
    if cases.is_empty() {
        Err(RecordedError::Empty {
            path: root.to_owned(),
        })
    } else {
        Ok(cases)
    }
}

/// No occlusion; then the occlusion of truth.json, or else of the middle, if it hides a pose.
fn occlusions(facts: &TruthFacts, log: &Log) -> Vec<Occlusion> {
    let occlusion = match facts.occlude_from {
        Some(from) => Occlusion::Rows { from, to: None },
        None => Occlusion::Middle { seconds: OCCLUSION },
    };
    let hides = occlusion
        .hidden(log)
        .iter()
        .zip(&log.object)
        .any(|(hidden, pose)| *hidden && pose.is_some());
    std::iter::once(Occlusion::None)
        .chain(hides.then_some(occlusion))
        .collect()
}

fn truth_facts(folder: &Path) -> Result<TruthFacts, RecordedError> {
    let path = folder.join("truth.json");
    if path.is_file() {
        read_truth_json(&text(&path)?, &shown(&path)).map_err(content)
    } else {
        Ok(TruthFacts::default())
    }
}

fn scene_names(folder: &Path) -> Result<Vec<String>, RecordedError> {
    let names = entries(folder)?
        .into_iter()
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()));
    Ok(names
        .filter(|name| {
            name == "scene.toml" || name.starts_with("scene-") && name.ends_with(".toml")
        })
        .collect())
}

fn folders_with_log(root: &Path) -> Result<Vec<PathBuf>, RecordedError> {
    let mut found = Vec::new();
    if root.join("log.csv").is_file() {
        found.push(root.to_owned());
    }
    for path in entries(root)?.into_iter().filter(|path| path.is_dir()) {
        found.extend(folders_with_log(&path)?);
    }
    Ok(found)
}

/// Contents of a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, RecordedError> {
    let read = || {
        fs::read_dir(folder)?
            .map(|entry| Ok(entry?.path()))
            .collect::<std::io::Result<Vec<_>>>()
    };
    let mut paths = read().map_err(|cause| RecordedError::File {
        path: folder.to_owned(),
        cause,
    })?;
    paths.sort();
    Ok(paths)
}

fn text(path: &Path) -> Result<String, RecordedError> {
    fs::read_to_string(path).map_err(|cause| RecordedError::File {
        path: path.to_owned(),
        cause,
    })
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn content(error: impl std::error::Error + Send + Sync + 'static) -> RecordedError {
    RecordedError::Content(Box::new(error))
}
