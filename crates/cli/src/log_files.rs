//! The files that a path to a log stands for: [`LogFiles`].

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use anyhow::Result;
use stickslip::Log;
use stickslip_formats::{
    BagInfo, BagOptions, LogWarning, McapError, McapProblem, read_bag, read_bag_info,
    read_bag_metadata, read_log,
};

use crate::experiment::{open, text_of, unreadable};
use crate::failure::hinted;
use crate::output::talk;
use crate::verdict::Verdict;

/// File that lists the files of a bag in its folder.
const METADATA: &str = "metadata.yaml";

/// A log's files: a table, or the recordings of a bag.
pub struct LogFiles {
    /// The given path.
    shown: PathBuf,
    /// Files that are there; one or more.
    pub paths: Vec<PathBuf>,
    /// Files that should be there.
    missing: Vec<PathBuf>,
    is_bag: bool,
    /// True for a bag's folder without a list of its files.
    unlisted: bool,
}

/// Kind of a file by its first bytes.
enum Kind {
    Mcap,
    /// A bag of ROS 2 as it was recorded before MCAP.
    Sqlite,
    Zstd,
    Other,
}

/// The log that a path stands for: a file itself; of a folder log.csv, log.mcap, the bag that the
/// folder is, or the only bag in it.
pub fn log_path(folder: &Path) -> PathBuf {
    if folder.is_file() {
        return folder.to_owned();
    }
    let [csv, mcap] = ["log.csv", "log.mcap"].map(|name| folder.join(name));
    let found = [&csv, &mcap].into_iter().find(|path| path.is_file());
    if let Some(found) = found {
        return found.clone();
    }
    if is_bag(folder) {
        return folder.to_owned();
    }
    match folder_entries(folder)
        .into_iter()
        .filter(|path| is_bag(path))
        .collect::<Vec<_>>()
        .as_slice()
    {
        [only] => only.clone(),
        _ => csv,
    }
}

/// Returns true if a folder is one of `ros2 bag record`.
pub fn is_bag(folder: &Path) -> bool {
    folder.join(METADATA).is_file() || !recordings_in(folder).is_empty()
}

impl LogFiles {
    /// The files of a log, a bag's folder or an experiment's folder.
    pub fn find(path: &Path) -> Result<Self> {
        let path = &if path.is_dir() {
            log_path(path)
        } else {
            path.to_owned()
        };
        if !path.is_dir() {
            let name = path.to_string_lossy().to_lowercase();
            return Ok(Self {
                shown: path.clone(),
                paths: vec![path.clone()],
                missing: Vec::new(),
                is_bag: [".mcap", ".mcap.zstd"]
                    .iter()
                    .any(|end| name.ends_with(end)),
                unlisted: false,
            });
        }
        let metadata = path.join(METADATA);
        let listed = if metadata.is_file() {
            let text = text_of(&metadata, "metadata")?;
            let bag = read_bag_metadata(&text, &metadata.display().to_string())?;
            if let Some(storage) = bag.other_storage() {
                return Err(not_mcap(path, storage));
            }
            let files = bag.relative_file_paths.iter();
            files.map(|file| in_folder(path, Path::new(file))).collect()
        } else {
            recordings_in(path)
        };
        let (paths, missing): (Vec<PathBuf>, _) =
            listed.into_iter().partition(|file| file.is_file());
        match paths.is_empty() {
            true => Err(hinted(
                format!(
                    "{}: none of the bag's files is there: {}",
                    path.display(),
                    names(&missing)
                ),
                "copy the whole folder",
            )),
            false => Ok(Self {
                shown: path.clone(),
                paths,
                missing,
                is_bag: true,
                unlisted: !metadata.is_file(),
            }),
        }
    }

    /// Describes a bag.
    pub fn info(&self) -> Result<(BagInfo, Vec<LogWarning>)> {
        self.require_bag()?;
        Ok(read_bag_info(self.open_all()?)?)
    }

    /// Refuses a log that is no bag.
    pub fn require_bag(&self) -> Result<()> {
        if self.is_bag {
            return Ok(());
        }
        // a bag of another kind says what to do with it
        self.opened(&self.shown)?;
        Err(hinted(
            format!("{}: this is no bag", self.shown.display()),
            "give the folder of a bag, or an .mcap file; `stickslip check` reads tables",
        ))
    }

    /// All files by name.
    pub fn open_all(&self) -> Result<Vec<(String, BufReader<File>)>> {
        let open = |path: &PathBuf| {
            let file = BufReader::new(self.opened(path)?);
            Ok((path.display().to_string(), file))
        };
        self.paths.iter().map(open).collect()
    }

    /// Warnings about the files and about their content, in words.
    pub fn warnings(&self, of_content: &[LogWarning]) -> Vec<String> {
        let bag = self.shown.display();
        let unlisted = self.unlisted.then(|| {
            format!("{bag}: no {METADATA}, the recorder was not stopped; its .mcap files are read")
        });
        let missing = (!self.missing.is_empty()).then(|| {
            let names = names(&self.missing);
            format!("{bag}: {names} is not there; its messages are lost")
        });
        let of_content = of_content.iter().map(LogWarning::to_string);
        unlisted
            .into_iter()
            .chain(of_content)
            .chain(missing)
            .collect()
    }

    /// Tells warnings, and whether they are about lost input.
    pub fn told(&self, warnings: &[LogWarning]) -> Verdict {
        for warning in self.warnings(warnings) {
            talk(format_args!("warning: {warning}"));
        }
        let lost = !self.missing.is_empty() || warnings.iter().any(LogWarning::is_loss);
        if lost {
            Verdict::InputLost
        } else {
            Verdict::Done
        }
    }

    /// Reads them; an error about a topic names the option that chooses another.
    pub fn read(&self, options: &BagOptions) -> Result<(Log, Vec<LogWarning>)> {
        let option = |key: &str, topic: &str| format!("--topic {key}={topic}");
        let read = self.read_quietly(options);
        read.map_err(|error| topic_hint(error, option))
    }

    /// Reads them.
    pub fn read_quietly(&self, options: &BagOptions) -> Result<(Log, Vec<LogWarning>)> {
        let mut files = self.open_all()?;
        if self.is_bag {
            return Ok(read_bag(files, options)?);
        }
        if !(options.topics.is_default() && options.part.is_whole()) {
            let log = self.shown.display();
            return Err(hinted(
                format!(
                    "{log}: topics are for MCAP logs, whose names end in .mcap, and so are times of a part"
                ),
                "leave them out",
            ));
        }
        let (name, file) = files.remove(0);
        Ok(read_log(file, &name)?)
    }

    /// A file that is of the kind that its name says.
    fn opened(&self, path: &Path) -> Result<File> {
        let name = path.display();
        let mut file = open(path, "log")?;
        if !file.metadata().is_ok_and(|there| there.is_file()) {
            return Err(hinted(
                format!("{name}: this is a pipe or a device; a log is read from a file"),
                "write it into a file first, and give that",
            ));
        }
        let kind = kind_of(&mut file).map_err(|error| unreadable(path, "log", &error))?;
        match kind {
            Kind::Sqlite => Err(not_mcap(path, "sqlite3")),
            Kind::Zstd if !self.is_bag => Err(hinted(
                format!("{name}: the whole file is packed with zstd"),
                format!("unpack it with `zstd -d {name}`"),
            )),
            Kind::Mcap if !self.is_bag => Err(hinted(
                format!("{name}: this is an MCAP recording by another name"),
                "let its name end in .mcap",
            )),
            _ => Ok(file),
        }
    }
}

/// A file of a bag; bags of early versions list it behind the name of their folder.
fn in_folder(folder: &Path, file: &Path) -> PathBuf {
    let listed = folder.join(file);
    let plain = file.file_name().map(|name| folder.join(name));
    plain
        .filter(|plain| !listed.is_file() && plain.is_file())
        .unwrap_or(listed)
}

/// The error about a bag whose files are no MCAP.
fn not_mcap(path: &Path, found: &str) -> anyhow::Error {
    let own = path.is_dir().then_some(path);
    let named = own
        .or(path.parent())
        .filter(|folder| *folder != Path::new(""));
    // a file in the working folder has no folder in its path
    let (bag, new) = named.map_or_else(
        || (".".to_owned(), "bag_mcap".to_owned()),
        |folder| {
            let new = folder.with_extension("").display().to_string() + "_mcap";
            (folder.display().to_string(), new)
        },
    );
    hinted(
        format!(
            "{}: this is a bag in {}; bags are read as MCAP",
            path.display(),
            if found == "sqlite3" {
                "SQLite (.db3)"
            } else {
                found
            }
        ),
        format!(
            "convert it: write `output_bags: [{{uri: {new}, storage_id: mcap, all: true}}]` into convert.yaml, then `ros2 bag convert -i {bag} -o convert.yaml`; \
             without ROS: `pip install rosbags`, then `rosbags-convert --src {bag} --dst {new} --dst-storage mcap`. Record with `ros2 bag record -s mcap`"
        ),
    )
}

/// Recordings in a folder by name.
fn recordings_in(folder: &Path) -> Vec<PathBuf> {
    let ends = |path: &PathBuf| {
        let name = path.to_string_lossy().to_lowercase();
        [".mcap", ".mcap.zstd", ".db3"]
            .iter()
            .any(|end| name.ends_with(end))
    };
    let mut found: Vec<PathBuf> = folder_entries(folder).into_iter().filter(ends).collect();
    found.retain(|path| path.is_file());
    found
}

/// Content of a folder, by name; nothing where it cannot be read.
fn folder_entries(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .collect();
    paths.sort();
    paths
}

fn names(paths: &[PathBuf]) -> String {
    let name = |path: &PathBuf| {
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    paths.iter().map(name).collect::<Vec<_>>().join(", ")
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

/// Adds how a topic is named. `option` has the words for it, of a key and its topic.
pub fn topic_hint(error: anyhow::Error, option: impl Fn(&str, &str) -> String) -> anyhow::Error {
    let Some(read) = error.downcast_ref::<McapError>() else {
        return error;
    };
    let named = |key: &str| format!("name it with {}", option(key, "TOPIC"));
    let help = match *read.problem {
        McapProblem::MissingTopic { topic, .. } => named(&topic.to_string()),
        McapProblem::Gap { missing } => named(&missing.to_string()),
        McapProblem::JumpsBack {
            log_times: Some([to, from]),
            ..
        } => format!("read one run: --to {to}, or --from {from}"),
        McapProblem::Frame { wrench: true, .. } => {
            format!("leave forces out with {}", option("wrench", ""))
        }
        _ => return error,
    };
    hinted(error.to_string(), help)
}
