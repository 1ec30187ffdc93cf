//! A log of the page with its scene: [`Opened`], and where it comes from: [`Source`].

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use serde::Deserialize;
use stickslip_formats::{BagOptions, Experiment, LogWarning, TruthFacts, read_log, read_scene};

use super::SCENES;
use crate::experiment::{read_quietly, text_of};
use crate::failure::hinted;
use crate::log_files::{LogFiles, log_path};
use crate::since_start::since_start;

/// Where a log comes from.
#[derive(Clone)]
pub enum Source {
    /// An experiment folder, read when it is asked for.
    Folder(PathBuf),
    /// Files that were dropped on the page.
    Dropped(Arc<Opened>),
}

/// A log and its scene.
pub struct Opened {
    /// Name in the list.
    pub name: String,
    /// Words by which `stickslip filter` reads it.
    pub given: [String; 2],
    /// The scene's file.
    pub scene: String,
    /// Scene, log, and the truth where it is known.
    pub experiment: Experiment,
    /// Warnings about parts of the log that were lost in reading.
    pub warnings: Vec<String>,
    /// Times of the rows as pages show them (s).
    pub times: Vec<f64>,
}

/// A file that was dropped on the page.
#[derive(Deserialize)]
pub struct DroppedFile {
    name: String,
    text: String,
}

impl Source {
    /// Reads the log, which is called `name` in the list.
    pub fn read(&self, name: &str) -> Result<Arc<Opened>> {
        match self {
            Self::Dropped(opened) => Ok(opened.clone()),
            Self::Folder(folder) => {
                let scene = SCENES.of(folder);
                let log = log_path(folder);
                let files = LogFiles::find(&log)?;
                let topics = BagOptions::default();
                let (experiment, warnings) = read_quietly(&scene, &log, &files, &topics, None)?;
                let given = [folder, &scene].map(|path| path.display().to_string());
                let text = text_of(&scene, "scene")?;
                let read = (experiment, files.warnings(&warnings));
                Ok(Arc::new(Opened::new(name.to_owned(), given, text, read)))
            }
        }
    }
}

impl Opened {
    fn new(
        name: String,
        given: [String; 2],
        scene: String,
        (experiment, warnings): (Experiment, Vec<String>),
    ) -> Self {
        let times = since_start(&experiment, Vec::new()).0.log.time;
        Self {
            name,
            given,
            scene,
            experiment,
            warnings,
            times,
        }
    }

    /// The log that a scene and a table are, the one of this number in the list.
    pub fn of_files(files: &[DroppedFile], number: usize) -> Result<Self> {
        let help = "drop two files together: a scene (.toml) and its log (.csv); \
                    `stickslip view FOLDER` reads bags";
        if let Some(file) = files.iter().find(|file| file.name.contains(['/', '\\'])) {
            return Err(hinted(
                format!("`{}`: a path and no file name", file.name),
                help,
            ));
        }
        let ends = |end: &str| -> Vec<&DroppedFile> {
            let is = |name: &str| name.to_lowercase().ends_with(end);
            files.iter().filter(|file| is(&file.name)).collect()
        };
        let (scenes, logs) = (ends(".toml"), ends(".csv"));
        let ([scene], [log], 2) = (scenes.as_slice(), logs.as_slice(), files.len()) else {
            let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
            let found = format!("{}: not a scene and a log", names.join(", "));
            return Err(hinted(found, help));
        };
        let setup = read_scene(&scene.text, &scene.name)?;
        let (table, warnings) = read_log(log.text.as_bytes(), &log.name)?;
        let experiment = Experiment::new(setup, table, None, TruthFacts::default())?;
        Ok(Self::new(
            format!("{number}: {}", log.name),
            [log.name.clone(), scene.name.clone()],
            scene.text.clone(),
            (
                experiment,
                warnings.iter().map(LogWarning::to_string).collect(),
            ),
        ))
    }

    /// The experiment without the truth, with times as pages show them.
    pub fn measured(&self) -> Experiment {
        let mut measured = self.experiment.clone();
        measured.log.time.clone_from(&self.times);
        measured.truth = None;
        measured
    }
}
