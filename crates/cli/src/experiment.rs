//! One experiment as files hold it: [`Experiment`], a scene, a log and what is known of the truth.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use stickslip::{Log, Reference, Setup};
use stickslip_formats::{Truth, TruthFacts, check_sensors, read_log, read_scene, read_truth_csv, read_truth_json};

use crate::failure::hinted;

/// Standard deviation of an object position where the scene has no `[camera]` (m).
const POSITION_STD: f64 = 3e-4;

/// Largest offset between a truth row and its log row that is only rounding (s).
const SAME_TIME: f64 = 1e-4;

/// A scene, a log and what is known of the truth.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Scene, sensors and filter settings.
    pub setup: Setup,
    /// The log.
    pub log: Log,
    /// The exact motion, where it is known.
    pub truth: Option<Truth>,
    /// True friction values and events; all `None` where nothing is known.
    pub facts: TruthFacts,
}

/// The texts of an experiment's files.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'a> {
    /// Name shown in errors.
    pub name: &'a str,
    /// scene.toml.
    pub scene: &'a str,
    /// log.csv.
    pub log: &'a str,
    /// truth.csv.
    pub truth_csv: &'a str,
    /// truth.json.
    pub truth_json: &'a str,
}

impl Experiment {
    /// Reads a scene, a log and the truth: `truth`, else truth.csv beside the log, and truth.json beside it.
    pub fn read(scene: &Path, log: &Path, truth: Option<&Path>) -> Result<Self> {
        let setup = read_scene_file(scene)?;
        let log_data = read_log_file(log)?;
        check_sensors(&log_data, &setup).with_context(|| format!("{} and {}", log.display(), scene.display()))?;
        let folder = log.parent().unwrap_or(Path::new(""));
        let beside = Some(folder.join("truth.csv")).filter(|path| path.is_file());
        let truth = truth.map(Path::to_path_buf).or(beside).map(|path| read_truth_file(&path)).transpose()?;
        let facts = Some(folder.join("truth.json")).filter(|path| path.is_file()).map(|path| read_facts_file(&path)).transpose()?;
        Ok(Self { setup, log: log_data, truth, facts: facts.unwrap_or_default() })
    }

    /// Reads an experiment folder.
    pub fn read_folder(folder: &Path, scene_name: &str) -> Result<Self> {
        Self::read(&folder.join(scene_name), &folder.join("log.csv"), None)
    }

    /// Parses an experiment from texts.
    pub fn parse(texts: Texts<'_>) -> Result<Self> {
        let name = |file: &str| format!("{}/{file}", texts.name);
        Ok(Self {
            setup: read_scene(texts.scene, &name("scene.toml"))?,
            log: read_log(texts.log.as_bytes(), &name("log.csv"))?.0,
            truth: Some(read_truth_csv(texts.truth_csv.as_bytes(), &name("truth.csv"))?),
            facts: read_truth_json(texts.truth_json, &name("truth.json"))?,
        })
    }

    /// What estimates are scored against: the truth at the log's times, else the log's own poses.
    pub fn reference(&self) -> Reference {
        let camera = self.setup.camera.as_ref();
        let latency = camera.map_or(0.0, |camera| camera.latency);
        let of_log = Reference::of_log(&self.log, latency, camera.map_or(POSITION_STD, |camera| camera.position_std));
        let first_pusher_contact = self.facts.first_pusher_contact;
        match &self.truth {
            None => Reference { first_pusher_contact, ..of_log },
            Some(truth) => Reference {
                pose: self.log.time.iter().map(|time| pose_at(truth, *time)).collect(),
                latency: 0.0,
                first_pusher_contact,
                rest: 1e-5,
                ..of_log
            },
        }
    }

    /// What the reference is, in words.
    pub fn reference_name(&self) -> &'static str {
        if self.truth.is_some() { "the truth" } else { "the log's own poses" }
    }

    /// Length of the log (s).
    pub fn duration(&self) -> f64 {
        self.log.time.last().copied().unwrap_or(0.0) - self.log.time.first().copied().unwrap_or(0.0)
    }

    /// Weight of an angle in the scores: `given`, else the radius of gyration (m).
    pub fn virtual_radius(&self, given: Option<f64>) -> f64 {
        given.unwrap_or_else(|| self.setup.scene.object.gyration_radius())
    }
}

/// The true pose at `time`, linear between rows; `None` outside them.
fn pose_at(truth: &Truth, time: f64) -> Option<stickslip::dynamics::Pose> {
    let later = truth.time.partition_point(|t| *t < time - SAME_TIME);
    let after = *truth.time.get(later)?;
    if after <= time + SAME_TIME {
        return Some(truth.pose[later]);
    }
    let earlier = later.checked_sub(1)?;
    let fraction = (time - truth.time[earlier]) / (after - truth.time[earlier]);
    Some(truth.pose[earlier].interpolate(truth.pose[later], fraction))
}

/// Reads a scene file.
pub fn read_scene_file(path: &Path) -> Result<Setup> {
    Ok(read_scene(&text_of(path, "scene")?, &path.display().to_string())?)
}

/// Reads a log; its warnings go to standard error.
pub fn read_log_file(path: &Path) -> Result<Log> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) {
        return Err(hinted(format!("{}: MCAP logs cannot be read yet", path.display()), "write the log as CSV, one row per camera frame"));
    }
    let (log, warnings) = read_log(bytes_of(path, "log")?.as_slice(), &path.display().to_string())?;
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
    Ok(log)
}

fn read_truth_file(path: &Path) -> Result<Truth> {
    Ok(read_truth_csv(bytes_of(path, "truth")?.as_slice(), &path.display().to_string())?)
}

fn read_facts_file(path: &Path) -> Result<TruthFacts> {
    Ok(read_truth_json(&text_of(path, "truth")?, &path.display().to_string())?)
}

/// The text of a file; `what` it is.
pub fn text_of(path: &Path, what: &str) -> Result<String> {
    fs::read_to_string(path).map_err(|error| unreadable(path, what, &error))
}

fn bytes_of(path: &Path, what: &str) -> Result<Vec<u8>> {
    fs::read(path).map_err(|error| unreadable(path, what, &error))
}

fn unreadable(path: &Path, what: &str, error: &std::io::Error) -> anyhow::Error {
    let help = if path.is_dir() {
        format!("give the {what} file itself; whole folders are for `stickslip compare`")
    } else {
        format!("give the path of the {what} file")
    };
    hinted(format!("{}: the {what} cannot be read: {error}", path.display()), help)
}
