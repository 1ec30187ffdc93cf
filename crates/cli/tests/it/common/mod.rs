//! Copies of the embedded experiments, to be broken on purpose.
pub mod page_session;
#[cfg(feature = "camera")]
pub mod rendered;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Recorded grasp that jams.
pub const STOP: &str = "stop-square50-bar-000";

/// Recorded grasp that slides.
pub const SLIDE: &str = "slide-ell-disc-110";

/// The program.
pub fn stickslip() -> Command {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
}

/// Runs the program; it must succeed.
#[track_caller]
pub fn succeeds(command: &mut Command) -> Output {
    let run = command.output().unwrap();
    assert_eq!(
        run.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    run
}

/// Output of the program as JSON; it must succeed.
#[track_caller]
pub fn json(command: &mut Command) -> serde_json::Value {
    serde_json::from_slice(&succeeds(command).stdout).unwrap()
}

/// An empty folder of this test run.
pub fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A copy of an experiment folder.
pub struct Experiment {
    /// The copy.
    pub folder: PathBuf,
}

impl Experiment {
    /// Copies a recorded grasp.
    pub fn copy(name: &str, test: &str) -> Self {
        let (folder, source) = (
            empty_folder(test),
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../testkit/experiments")
                .join(name),
        );
        for file in ["scene.toml", "log.csv", "truth.csv", "truth.json"] {
            fs::copy(source.join(file), folder.join(file)).unwrap();
        }
        Self { folder }
    }

    /// Path of the log.
    pub fn log(&self) -> String {
        self.folder.join("log.csv").display().to_string()
    }

    /// Path of the scene.
    pub fn scene(&self) -> String {
        self.folder.join("scene.toml").display().to_string()
    }

    /// Rewrites a file.
    pub fn edit(&self, file: &str, change: impl FnOnce(String) -> String) {
        let path = self.folder.join(file);
        let text = change(fs::read_to_string(&path).unwrap());
        fs::write(path, text).unwrap();
    }

    /// Takes the pusher's stall force out of the scene.
    pub fn forget_stall_force(&self) {
        self.edit("scene.toml", |text| {
            let kept = text.lines().filter(|line| !line.starts_with("stall_force"));
            kept.collect::<Vec<_>>().join("\n")
        });
    }

    /// Rewrites the log's cells as numbers, a row of them for each line after the header; NaN is an
    /// empty cell.
    pub fn edit_rows(&self, change: impl FnOnce(&mut Vec<Vec<f64>>)) {
        self.edit("log.csv", |text| {
            let (header, body) = text.split_once('\n').unwrap();
            let numbers = |line: &str| {
                line.split(',')
                    .map(|cell| cell.parse().unwrap_or(f64::NAN))
                    .collect()
            };
            let mut rows: Vec<Vec<f64>> = body.lines().map(numbers).collect();
            change(&mut rows);
            let cell = |value: &f64| {
                if value.is_nan() {
                    String::new()
                } else {
                    value.to_string()
                }
            };
            let lines = rows
                .iter()
                .map(|row| row.iter().map(cell).collect::<Vec<_>>().join(","));
            [header.trim_end().to_owned()]
                .into_iter()
                .chain(lines)
                .collect::<Vec<_>>()
                .join("\n")
                + "\n"
        });
    }
}
