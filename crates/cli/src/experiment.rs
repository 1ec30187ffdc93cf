//! Experiments from files: [`read_experiment`], [`read_folder`], and from [`Texts`] inside the
//! program.

use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use stickslip::{Log, Occlusion, Setup};
use stickslip_formats::{
    Experiment, McapError, McapProblem, Topics, Truth, TruthFacts, read_log, read_log_mcap,
    read_scene, read_truth_csv, read_truth_json,
};

use crate::failure::hinted;
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

/// Reads a scene, a log and the truth: `truth`, else truth.csv beside the log, and truth.json
/// beside it. The verdict says whether all of the log could be read.
pub fn read_experiment(
    scene: &Path,
    log: &Path,
    topics: &Topics,
    truth: Option<&Path>,
) -> Result<(Experiment, Verdict)> {
    let setup = read_scene_file(scene)?;
    let (log_data, verdict) = read_log_file(log, topics)?;
    let folder = log.parent().unwrap_or(Path::new(""));
    let beside = |name: &str| Some(folder.join(name)).filter(|path| path.is_file());
    let truth = truth
        .map(Path::to_path_buf)
        .or(beside("truth.csv"))
        .map(|path| read_truth_file(&path))
        .transpose()?;
    let facts = beside("truth.json")
        .map(|path| read_facts_file(&path))
        .transpose()?
        .unwrap_or_default();
    let experiment = Experiment::new(setup, log_data, truth, facts)
        .with_context(|| format!("{} and {}", log.display(), scene.display()))?;
    Ok((experiment, verdict))
}

/// Reads an experiment folder.
pub fn read_folder(
    folder: &Path,
    scene_name: &str,
    topics: &Topics,
) -> Result<(Experiment, Verdict)> {
    read_experiment(&folder.join(scene_name), &log_path(folder), topics, None)
}

/// The log of a folder: log.csv, else log.mcap.
pub fn log_path(folder: &Path) -> PathBuf {
    let [csv, mcap] = ["log.csv", "log.mcap"].map(|name| folder.join(name));
    if !csv.is_file() && mcap.is_file() {
        mcap
    } else {
        csv
    }
}

/// An occlusion that hides no pose is a slip of the pen.
pub fn check_occlusion(occlusion: Occlusion, experiment: &Experiment) -> Result<()> {
    let hides = occlusion
        .hidden(&experiment.log)
        .iter()
        .zip(&experiment.log.object)
        .any(|(hidden, pose)| *hidden && pose.is_some());
    if occlusion == Occlusion::None || hides {
        return Ok(());
    }
    let rows = experiment.log.len();
    Err(hinted(
        format!("the occlusion hides no object pose of the log's {rows} rows"),
        format!("rows go from 0 to {}; choose a range among them", rows - 1),
    ))
}

/// What to call the experiment of a log: its folder where the log has the name that all have.
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

/// What an experiment's reference is, in words.
pub fn reference_name(experiment: &Experiment) -> &'static str {
    if experiment.truth.is_some() {
        "the truth"
    } else {
        "the log's own poses"
    }
}

/// Reads a scene file.
pub fn read_scene_file(path: &Path) -> Result<Setup> {
    Ok(read_scene(
        &text_of(path, "scene")?,
        &path.display().to_string(),
    )?)
}

/// Reads a log, CSV or MCAP by the file's ending; its warnings go to standard error. The verdict
/// says whether all of it could be read.
pub fn read_log_file(path: &Path, topics: &Topics) -> Result<(Log, Verdict)> {
    let name = path.display().to_string();
    let mut file = open(path, "log")?;
    let kind = kind_of(&mut file).map_err(|error| unreadable(path, "log", &error))?;
    let ends_as_mcap = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"));
    let (log, warnings) = match kind {
        Kind::Sqlite => {
            let help =
                "record with `ros2 bag record -s mcap`, or rewrite the bag with `ros2 bag convert`";
            return Err(hinted(
                format!("{name}: this is a bag in SQLite; logs are CSV or MCAP"),
                help,
            ));
        }
        Kind::Zstd => {
            let help = format!("unpack it with `zstd -d {name}`");
            return Err(hinted(
                format!("{name}: the whole file is packed with zstd"),
                help,
            ));
        }
        Kind::Mcap | Kind::Other if ends_as_mcap => {
            read_log_mcap(BufReader::new(file), &name, topics).map_err(topic_hint)?
        }
        Kind::Mcap => {
            let help = "let its name end in .mcap";
            return Err(hinted(
                format!("{name}: this is an MCAP recording by another name"),
                help,
            ));
        }
        Kind::Other if topics.is_default() => read_log(file, &name)?,
        Kind::Other => {
            return Err(hinted(
                format!("{name}: --topic is for MCAP logs, whose names end in .mcap"),
                "leave --topic out",
            ));
        }
    };
    for warning in &warnings {
        talk(format_args!("warning: {warning}"));
    }
    let lost = warnings.iter().any(|warning| warning.is_loss());
    Ok((
        log,
        if lost {
            Verdict::InputLost
        } else {
            Verdict::Done
        },
    ))
}

/// What a file is by its first bytes.
enum Kind {
    Mcap,
    /// A bag of ROS 2 as it was recorded before MCAP.
    Sqlite,
    Zstd,
    Other,
}

fn kind_of(file: &mut File) -> io::Result<Kind> {
    let mut start = Vec::new();
    file.take(16).read_to_end(&mut start)?;
    file.rewind()?;
    Ok(match start.as_slice() {
        [0x89, b'M', b'C', b'A', b'P', ..] => Kind::Mcap,
        [b'S', b'Q', b'L', b'i', b't', b'e', b' ', ..] => Kind::Sqlite,
        [0x28, 0xb5, 0x2f, 0xfd, ..] => Kind::Zstd,
        _ => Kind::Other,
    })
}

/// How to say on the command line which topic is meant.
fn topic_hint(error: McapError) -> anyhow::Error {
    match *error.problem {
        McapProblem::MissingTopic { topic, .. } => hinted(
            error.to_string(),
            format!("name it with --topic {topic}=TOPIC"),
        ),
        McapProblem::SensorNumber { missing } => hinted(
            error.to_string(),
            format!("name it with --topic fixel_{missing}=TOPIC"),
        ),
        McapProblem::Frame { wrench: true, .. } => {
            hinted(error.to_string(), "leave forces out with --topic wrench=")
        }
        _ => error.into(),
    }
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

/// The text of a file that is called `what` in errors.
pub fn text_of(path: &Path, what: &str) -> Result<String> {
    fs::read_to_string(path).map_err(|error| unreadable(path, what, &error))
}

fn open(path: &Path, what: &str) -> Result<File> {
    match File::open(path) {
        Ok(_) if path.is_dir() => Err(unreadable(path, what, &ErrorKind::IsADirectory.into())),
        opened => opened.map_err(|error| unreadable(path, what, &error)),
    }
}

fn unreadable(path: &Path, what: &str, error: &io::Error) -> anyhow::Error {
    let help = if path.join("metadata.yaml").is_file() {
        "this is the folder of a bag: give the .mcap file in it".to_owned()
    } else if path.is_dir() {
        format!("give the {what} file itself; whole folders are for `stickslip compare`")
    } else {
        format!("give the path of the {what} file")
    };
    hinted(
        format!("{}: the {what} cannot be read: {error}", path.display()),
        help,
    )
}
