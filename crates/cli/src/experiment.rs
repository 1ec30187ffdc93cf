//! Experiments from files: [`read_experiment`], [`read_folder`], and from [`Texts`] inside the
//! program.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use stickslip::diagnosis::refused;
use stickslip::{Log, Occlusion, Setup};
use stickslip_formats::{
    BagOptions, Experiment, LogWarning, Truth, TruthFacts, read_log, read_mounts, read_scene,
    read_truth_csv, read_truth_json, scene_assumptions,
};

use crate::arg_values::ForceArgs;
use crate::failure::hinted;
use crate::log_files::{LogFiles, log_path};
use crate::output::talk;
use crate::verdict::Verdict;

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

impl Texts<'_> {
    /// The experiment they hold.
    pub fn parse(&self) -> Result<Experiment> {
        let name = |file: &str| format!("{}/{file}", self.name);
        let setup = read_scene(self.scene, &name("scene.toml"))?;
        let (log, _) = read_log(self.log.as_bytes(), &name("log.csv"))?;
        let truth = read_truth_csv(self.truth_csv.as_bytes(), &name("truth.csv"))?;
        let facts = read_truth_json(self.truth_json, &name("truth.json"))?;
        Ok(Experiment::new(setup, log, Some(truth), facts)?)
    }
}

/// Reads a scene, a log and the truth. The truth is `truth`, else truth.csv next to the log, and
/// truth.json next to it. Warnings go to standard error; the verdict says whether all of the log
/// could be read.
pub fn read_experiment(
    scene: &Path,
    log: &Path,
    topics: &BagOptions,
    truth: Option<&Path>,
) -> Result<(Experiment, Verdict)> {
    let files = LogFiles::find(log)?;
    let (experiment, warnings) = read_quietly(scene, log, &files, topics, truth)?;
    Ok((experiment, files.told(&warnings)))
}

/// Reads the scene, the log of these files and the truth, with warnings about the log.
pub fn read_quietly(
    scene: &Path,
    log: &Path,
    files: &LogFiles,
    topics: &BagOptions,
    truth: Option<&Path>,
) -> Result<(Experiment, Vec<LogWarning>)> {
    let (setup, log_data, warnings) = read_scene_and_log(scene, files, topics)?;
    let own = Some(log).filter(|log| log.is_dir());
    let folders: Vec<&Path> = own.into_iter().chain(log.parent()).collect();
    let beside = |name: &str| {
        let mut paths = folders.iter().map(|folder| folder.join(name));
        paths.find(|path| path.is_file())
    };
    let truth = truth
        .map(Path::to_path_buf)
        .or(beside("truth.csv"))
        .map(|path| {
            let truth = read_truth_file(&path)?;
            check_clock(&path, &truth, &log_data).map(|()| truth)
        })
        .transpose()?;
    let facts = beside("truth.json")
        .map(|path| read_facts_file(&path))
        .transpose()?
        .unwrap_or_default();
    let experiment = Experiment::new(setup, log_data, truth, facts)
        .with_context(|| format!("{} and {}", log.display(), scene.display()))?;
    Ok((experiment, warnings))
}

/// Reads an experiment folder, or a log, with a scene.
pub fn read_folder(
    folder: &Path,
    scene: &Path,
    topics: &BagOptions,
) -> Result<(Experiment, Verdict)> {
    read_experiment(scene, &log_path(folder), topics, None)
}

/// An occlusion that hides no pose is a slip of the pen, and one that hides every pose leaves
/// nothing to start from.
pub fn check_occlusion(occlusion: Occlusion, log: &Log) -> Result<()> {
    if occlusion == Occlusion::None {
        return Ok(());
    }
    let rows = log.len();
    let hidden = occlusion.hidden(log);
    let measured: Vec<usize> = (0..rows).filter(|row| log.object[*row].is_some()).collect();
    let hides = measured.iter().filter(|row| hidden[**row]).count();
    match measured.as_slice() {
        [first, ..] if hides == measured.len() => Err(hinted(
            format!(
                "the occlusion hides all {hides} object poses of the log; one is needed to start from"
            ),
            format!("hide rows from {} on", first + 1),
        )),
        _ if hides == 0 => Err(hinted(
            format!("the occlusion hides no object pose of the log's {rows} rows"),
            format!("rows go from 0 to {}; choose a range among them", rows - 1),
        )),
        _ => Ok(()),
    }
}

/// Refuses an experiment whose units, frames or columns are found to be wrong, unless `--force`
/// asks for a run.
pub fn check_sense(force: &ForceArgs, experiment: &Experiment) -> Result<()> {
    match force.force {
        true => Ok(()),
        false => refuse_nonsense(&experiment.setup, &experiment.log, "--force"),
    }
}

/// Refuses a log whose units, frames or columns are found to be wrong. `force` is the option that
/// runs all the same.
pub fn refuse_nonsense(setup: &Setup, log: &Log, force: &str) -> Result<()> {
    let found = refused(setup, log);
    found.map_or(Ok(()), |finding| {
        let advice = finding.advice.unwrap_or_default();
        let help =
            format!("{advice}. `stickslip check` shows all findings; {force} runs all the same");
        Err(hinted(finding.found, help))
    })
}

/// Longest step of a log that is in seconds (s).
const LONGEST_STEP: f64 = 5.0;

/// Refuses a truth on another clock: none of its times is among the log's.
fn check_clock(path: &Path, truth: &Truth, log: &Log) -> Result<()> {
    let ends = |time: &[f64]| Some([*time.first()?, *time.last()?]);
    let (Some([from, to]), Some([first, last])) = (ends(&truth.time), ends(&log.time)) else {
        return Ok(());
    };
    // a log whose own steps are too long has another fault, which is named later
    let steps = log
        .time
        .windows(2)
        .all(|pair| pair[1] - pair[0] < LONGEST_STEP);
    if !steps || (from <= last && first <= to) {
        return Ok(());
    }
    Err(hinted(
        format!(
            "{}: no time in common with the log: the truth goes from {from} to {to} s, the log from {first} to {last} s",
            path.display()
        ),
        "write both on one clock, in seconds",
    ))
}

/// Name of the experiment of a log: its folder where the log has the name that all have.
pub fn experiment_name(log: &Path) -> String {
    let folder = log.parent().and_then(Path::file_name);
    let own = matches!(
        log.file_name().and_then(|name| name.to_str()),
        Some("log.csv" | "log.mcap")
    );
    let name = folder.filter(|_| own).or(log.file_name());
    name.map_or_else(
        || log.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Name of an experiment's reference, in words.
pub fn reference_name(experiment: &Experiment) -> &'static str {
    if experiment.truth.is_some() {
        "the truth"
    } else {
        "the log's own poses"
    }
}

/// Reads a scene file.
pub fn read_scene_file(path: &Path) -> Result<Setup> {
    parse_scene(&text_of(path, "scene")?, &path.display().to_string())
}

fn parse_scene(text: &str, name: &str) -> Result<Setup> {
    let setup = read_scene(text, name)?;
    for line in scene_assumptions(text, name)? {
        talk(format_args!("note: {name}: {line}"));
    }
    Ok(setup)
}

/// Reads a scene and a log with it. The verdict says whether all of the log could be read.
pub fn read_scene_and_log(
    scene: &Path,
    log: &LogFiles,
    topics: &BagOptions,
) -> Result<(Setup, Log, Vec<LogWarning>)> {
    // once, since it may be a pipe
    let (text, name) = (text_of(scene, "scene")?, scene.display().to_string());
    let setup = parse_scene(&text, &name)?;
    let options = BagOptions {
        mounts: read_mounts(&text, &name)?,
        touch_force: setup.tactile.touch_force,
        ..topics.clone()
    };
    let (log, warnings) = log.read(&options)?;
    Ok((setup, log, warnings))
}

/// The scene of a log that is given without one: `scene.toml` in the given folder, else next to the
/// log.
pub fn scene_beside(given: &Path) -> Result<PathBuf> {
    // as the user would write it, where that shows the folder above
    let path = match given.file_name() {
        Some(_) => given.to_owned(),
        None => std::path::absolute(given).unwrap_or(given.to_owned()),
    };
    let above: Vec<&Path> = path
        .ancestors()
        .skip(usize::from(!path.is_dir()))
        .take(2)
        .collect();
    let found = above
        .iter()
        .map(|folder| folder.join("scene.toml"))
        .find(|scene| scene.is_file());
    found.ok_or_else(|| {
        hinted(
            format!(
                "{}: there is no scene.toml in it or next to it",
                given.display()
            ),
            "give the scene with --scene; docs/guide/formats.md says how to write one",
        )
    })
}

fn read_truth_file(path: &Path) -> Result<Truth> {
    Ok(read_truth_csv(
        open(path, "truth")?,
        &path.display().to_string(),
    )?)
}

/// Reads a truth.json.
pub fn read_facts_file(path: &Path) -> Result<TruthFacts> {
    Ok(read_truth_json(
        &text_of(path, "truth")?,
        &path.display().to_string(),
    )?)
}

/// Largest text file that is read as a whole (bytes).
const LARGEST_TEXT: u64 = 64_000_000;

/// The text of a file that is called `what` in errors.
pub fn text_of(path: &Path, what: &str) -> Result<String> {
    let mut bytes = Vec::new();
    let read = open(path, what)?
        .take(LARGEST_TEXT + 1)
        .read_to_end(&mut bytes);
    read.map_err(|error| unreadable(path, what, &error))?;
    if bytes.len() as u64 > LARGEST_TEXT {
        let error = format!("it has more than {} MB", LARGEST_TEXT / 1_000_000);
        return Err(unreadable(path, what, &io::Error::other(error)));
    }
    String::from_utf8(bytes).map_err(|_| {
        let error = io::Error::new(ErrorKind::InvalidData, "it is no text in UTF-8");
        unreadable(path, what, &error)
    })
}

/// Opens a file that is called `what` in errors.
pub fn open(path: &Path, what: &str) -> Result<File> {
    match File::open(path) {
        Ok(_) if path.is_dir() => Err(unreadable(path, what, &ErrorKind::IsADirectory.into())),
        opened => opened.map_err(|error| unreadable(path, what, &error)),
    }
}

/// The error about a file that cannot be read.
pub fn unreadable(path: &Path, what: &str, error: &io::Error) -> anyhow::Error {
    let file = format!("{} file", what.strip_suffix(" file").unwrap_or(what));
    let help = if path.is_dir() {
        format!("give the {file} itself")
    } else {
        format!("give the path of the {file}")
    };
    hinted(
        format!("{}: the {what} cannot be read: {error}", path.display()),
        help,
    )
}
