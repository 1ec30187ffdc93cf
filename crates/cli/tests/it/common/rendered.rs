//! An experiment as an overhead camera would have filmed it.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use super::{Experiment, SLIDE, stickslip, succeeds};

/// Rows of the experiment that are rendered: the object moves.
pub const ROWS: Range<usize> = 100..130;

/// Thirty frames of an experiment, the hand over the last ones, and its calibration.
pub static RENDERED: LazyLock<PathBuf> = LazyLock::new(|| {
    let case = Experiment::copy(SLIDE, "rendered");
    for file in ["log.csv", "truth.csv"] {
        case.edit(file, |text| {
            let lines: Vec<&str> = text.lines().collect();
            [&lines[..1], &lines[1 + ROWS.start..1 + ROWS.end]]
                .concat()
                .join("\n")
                + "\n"
        });
    }
    let out = case.folder.join("out");
    succeeds(
        stickslip()
            .args([
                "render",
                &case.folder.display().to_string(),
                "--board-frames",
                "8",
                "--cover",
                "24",
                "--repeat",
                "0.1",
                "--out",
            ])
            .arg(&out),
    );
    succeeds(&mut calibrate(&out.join("board"), &out));
    out
});

pub fn calibrate(frames: &Path, out: &Path) -> Command {
    let mut command = stickslip();
    command
        .arg("calibrate")
        .arg(frames)
        .arg("--board")
        .arg(out.join("board.toml"))
        .arg("--out")
        .arg(out.join("calibration.toml"));
    command
}

pub fn track(frames: &Path, tags: &Path, out: &Path, more: &[&str]) -> Command {
    let calibration = RENDERED.join("calibration.toml");
    let mut command = stickslip();
    command
        .arg("track")
        .arg(frames)
        .arg("--calibration")
        .arg(calibration)
        .arg("--tags")
        .arg(tags)
        .arg("--out")
        .arg(out);
    command.args(more);
    command
}

/// The run must fail, and say these words.
#[track_caller]
pub fn assert_refused(command: &mut Command, words: &[&str]) {
    let run = command.output().unwrap();
    let told = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(
        words.iter().all(|word| told.contains(word)),
        "{words:?} are not in\n{told}"
    );
}
