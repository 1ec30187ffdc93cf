//! Outputs of results: files are written whole or not at all, and a file that cannot be written is
//! reported before the run.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{Experiment, SLIDE, empty_folder, stickslip, succeeds};

/// `filter` on an experiment, with few particles.
fn filter(case: &Experiment) -> Command {
    let mut command = stickslip();
    command.args(["filter", &case.log(), "--scene", &case.scene()]);
    command.args(["--particles", "20"]);
    command
}

/// It failed before the run, whose scores would be on standard output.
#[track_caller]
fn assert_refused(run: &Output, words: &str) {
    let talk = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{talk}");
    assert!(run.stdout.is_empty() && talk.contains(words), "{talk}");
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_run() {
    let case = Experiment::copy(SLIDE, "outputs/refused");
    let log = fs::read(case.log()).unwrap();
    let file = case.folder.join("file");
    fs::write(&file, "mine").unwrap();
    let missing = file.join("below").display().to_string();
    let file = file.display().to_string();
    let folder = case.folder.display().to_string();
    for (arguments, words) in [
        (["--out", file.as_str()], "cannot be made"),
        (["--out", &missing], "cannot be made"),
        (["--report", &missing], "cannot be written"),
        (["--report", &folder], "cannot be written: is a directory"),
        (["--report", &case.log()], "would destroy what is read"),
        (["--report", &case.scene()], "would destroy what is read"),
    ] {
        assert_refused(&filter(&case).args(arguments).output().unwrap(), words);
    }
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    assert_eq!(fs::read(case.log()).unwrap(), log);

    let compare = stickslip()
        .args(["compare", &folder, "--report", &case.log()])
        .output()
        .unwrap();
    assert_refused(&compare, "would destroy what is read");
}

/// A reader sees the old file or the new one: never a part, never a mixture of two runs.
#[test]
fn two_runs_into_one_folder_leave_one_of_their_files() {
    let case = Experiment::copy(SLIDE, "outputs/two");
    let out = |name: &str| empty_folder(&format!("outputs/{name}"));
    let estimate = |seed: &str, folder: &Path| {
        let mut command = filter(&case);
        command.args(["--seed", seed, "--out"]).arg(folder);
        command.stdout(std::process::Stdio::null());
        command
    };
    let both = [("1", out("first")), ("2", out("second"))].map(|(seed, folder)| {
        assert!(estimate(seed, &folder).status().unwrap().success());
        fs::read(folder.join("estimate.csv")).unwrap()
    });
    let shared = out("shared");
    let file = shared.join("estimate.csv");
    for _ in 0..5 {
        let mut runs = ["1", "2"].map(|seed| estimate(seed, &shared).spawn().unwrap());
        while runs.iter_mut().any(|run| run.try_wait().unwrap().is_none()) {
            if let Ok(bytes) = fs::read(&file) {
                assert!(both.contains(&bytes), "a part of a file, or of two");
            }
        }
        assert!(both.contains(&fs::read(&file).unwrap()));
        assert_eq!(names(&shared), ["estimate.csv", "modes.csv"]);
    }
}

/// A full disk leaves the file that was there.
#[test]
#[cfg(target_os = "linux")]
fn a_file_that_cannot_be_finished_leaves_the_old_one() {
    let case = Experiment::copy(SLIDE, "outputs/full");
    let out = empty_folder("outputs/full_out");
    let file = out.join("estimate.csv");
    fs::write(&file, "old").unwrap();
    // no file may grow beyond 4 KiB, as on a full disk
    let run = Command::new("bash")
        .args(["-c", "trap '' XFSZ; ulimit -f 4; exec \"$@\"", "bash"])
        .arg(env!("CARGO_BIN_EXE_stickslip"))
        .args(["filter", &case.log(), "--scene", &case.scene()])
        .args(["--particles", "20", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let talk = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{talk}");
    assert!(talk.contains("estimate.csv: cannot be written"), "{talk}");
    // the scores of the run are not lost with the file
    assert!(String::from_utf8_lossy(&run.stdout).contains("pose RMSE"));
    assert_eq!(fs::read(&file).unwrap(), b"old");
    assert_eq!(names(&out), ["estimate.csv"]);
}

/// A new estimate.csv next to the modes.csv of an older run would be taken for one result.
#[test]
fn results_of_which_one_cannot_be_placed_leave_no_new_one_next_to_an_old_one() {
    let case = Experiment::copy(SLIDE, "outputs/pair");
    let out = empty_folder("outputs/pair_out");
    fs::write(out.join("estimate.csv"), "old").unwrap();
    // no file can take the place of a folder
    fs::create_dir(out.join("modes.csv")).unwrap();
    let run = filter(&case).arg("--out").arg(&out).output().unwrap();
    let talk = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{talk}");
    assert!(talk.contains("modes.csv: cannot be written"), "{talk}");
    assert_eq!(fs::read(out.join("estimate.csv")).unwrap(), b"old");
    assert_eq!(names(&out), ["estimate.csv", "modes.csv"]);
}

#[test]
#[cfg(unix)]
fn files_that_are_there_keep_their_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let case = Experiment::copy(SLIDE, "outputs/modes");
    let page = case.folder.join("page.html");
    let mode = || fs::metadata(&page).unwrap().permissions().mode() & 0o777;
    fs::write(&page, "private").unwrap();
    fs::set_permissions(&page, fs::Permissions::from_mode(0o640)).unwrap();
    succeeds(filter(&case).arg("--report").arg(&page));
    assert!(fs::read_to_string(&page).unwrap().starts_with("<!DOCTYPE"));
    assert_eq!(mode(), 0o640);

    fs::write(&page, "mine").unwrap();
    fs::set_permissions(&page, fs::Permissions::from_mode(0o400)).unwrap();
    let run = filter(&case).arg("--report").arg(&page).output().unwrap();
    assert_refused(&run, "the file there is write-protected");
    assert_eq!(
        (fs::read(&page).unwrap(), mode()),
        (b"mine".to_vec(), 0o400)
    );
}

#[test]
#[cfg(unix)]
fn streams_and_links_are_written_as_they_are() {
    let case = Experiment::copy(SLIDE, "outputs/links");
    let (link, target) = (case.folder.join("link.html"), case.folder.join("real.html"));
    fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    for place in [link.as_path(), Path::new("/dev/null")] {
        succeeds(filter(&case).arg("--report").arg(place));
    }
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(
        fs::read_to_string(&target)
            .unwrap()
            .starts_with("<!DOCTYPE html>")
    );
}
