//! The program as a user runs it: exit codes, the stream of each output, JSON keys, files written.

use std::fs;
use std::process::{Command, Output, Stdio};

use crate::common::{Experiment, STOP, json, stickslip, succeeds};

/// Few particles: these tests look at the program, not at the filter.
const FEW: [&str; 2] = ["--particles", "16"];

#[test]
fn filter_prints_scores_and_writes_only_the_estimate() {
    let case = Experiment::copy(STOP, "filter_prints");
    let out = case.folder.join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    let run = succeeds(
        stickslip()
            .args([
                "filter",
                &case.log(),
                "--scene",
                &case.scene(),
                "--occlude",
                "153",
                "--out",
            ])
            .arg(&out)
            .args(FEW),
    );
    let (told, talk) = (
        String::from_utf8(run.stdout).unwrap(),
        String::from_utf8(run.stderr).unwrap(),
    );
    for line in [
        "against the truth",
        "pose RMSE, occluded",
        "real-time factor",
        "mu_s",
        "d_tri",
    ] {
        assert!(told.contains(line), "{line} is missing in\n{told}");
    }
    assert!(
        talk.contains("wrote") && talk.contains("estimate.csv"),
        "{talk}"
    );
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine");
    let estimate = fs::read_to_string(out.join("estimate.csv")).unwrap();
    assert_eq!(
        estimate.lines().count(),
        fs::read_to_string(case.log()).unwrap().lines().count()
    );
}

#[test]
fn filter_json_has_the_contract_s_keys() {
    let case = Experiment::copy(STOP, "filter_json");
    let report = json(stickslip().args([
        "filter",
        &case.log(),
        "--scene",
        &case.scene(),
        "--method",
        "nominal",
        "--json",
    ]));
    for key in [
        "wmse_mm",
        "wmse_moving_mm",
        "final_error_mm",
        "final_error_deg",
        "frames",
        "unsolved",
        "failed",
        "real_time_factor",
    ] {
        assert!(report[key].is_number(), "{key}: {report}");
    }
    assert!(
        report["wmse_occluded_mm"].is_null(),
        "nothing is hidden: {report}"
    );
    let hidden = json(
        stickslip()
            .args([
                "filter",
                &case.log(),
                "--scene",
                &case.scene(),
                "--occlude",
                "100:200",
                "--json",
            ])
            .args(FEW),
    );
    assert!(
        hidden["wmse_occluded_mm"].is_number() && hidden["friction"]["mu_s"]["mean"].is_number(),
        "{hidden}"
    );
}

/// `filter` with few particles.
fn filter(case: &Experiment) -> Command {
    let mut command = stickslip();
    command
        .args(["filter", &case.log(), "--scene", &case.scene()])
        .args(FEW);
    command
}

/// 20 times 0.28 × 0.582177 kg × 9.81 m/s².
const ASSUMED: f64 = 31.9826;

#[test]
fn filter_says_which_stall_force_it_assumes_and_solves_the_jam() {
    let case = Experiment::copy(STOP, "filter_no_stall_force");
    let given = json(filter(&case).arg("--json"));
    assert_eq!(given["stall_force"], 24.837);
    assert_eq!(given["stall_force_assumed"], false);

    case.forget_stall_force();
    let assumed = json(filter(&case).arg("--json"));
    let force = assumed["stall_force"].as_f64().unwrap();
    assert!((force - ASSUMED).abs() < 1e-3, "{force}");
    assert_eq!(assumed["stall_force_assumed"], true);
    assert_eq!(assumed["unsolved"], 0);
    let text = String::from_utf8(filter(&case).output().unwrap().stdout).unwrap();
    assert!(
        text.lines().any(
            |line| line.starts_with("note: pusher.stall_force is missing")
                && line.contains("32.0 N is assumed")
                && line.contains("inf")
        ),
        "{text}"
    );
}

#[test]
fn filter_scores_against_the_log_where_there_is_no_truth() {
    let case = Experiment::copy(STOP, "filter_log_reference");
    fs::remove_file(case.folder.join("truth.csv")).unwrap();
    let run = stickslip()
        .args([
            "filter",
            &case.log(),
            "--scene",
            &case.scene(),
            "--method",
            "kalman",
        ])
        .output()
        .unwrap();
    assert!(
        String::from_utf8(run.stdout)
            .unwrap()
            .contains("against the log's own poses")
    );
}

#[test]
fn filter_gives_the_same_estimate_on_any_number_of_threads() {
    let case = Experiment::copy(STOP, "filter_threads");
    let estimate = |threads: &str| {
        let out = case.folder.join(threads);
        let run = stickslip()
            .args([
                "filter",
                &case.log(),
                "--scene",
                &case.scene(),
                "--threads",
                threads,
                "--particles",
                "300",
                "--out",
            ])
            .arg(&out)
            .output();
        assert_eq!(run.unwrap().status.code(), Some(0));
        fs::read(out.join("estimate.csv")).unwrap()
    };
    let one = estimate("1");
    assert!(one == estimate("3"));
    // more than there are processors, or particles for, neither hang nor count
    assert!(one == estimate("1000"));
}

#[test]
fn bad_arguments_exit_with_2() {
    let case = Experiment::copy(STOP, "bad_arguments");
    let (log, scene) = (case.log(), case.scene());
    let bad: [&[&str]; 7] = [
        &[],
        &["filter"],
        &["filter", &log, "--scene", &scene, "--method", "magic"],
        &["filter", &log, "--scene", &scene, "--occlude", "9:3"],
        &["filter", &log, "--scene", &scene, "--particles", "0"],
        &[
            "filter",
            &log,
            "--scene",
            &scene,
            "--occlude",
            "3",
            "--occlude-middle",
            "1",
        ],
        &["compare"],
    ];
    for arguments in bad {
        assert_eq!(
            stickslip().args(arguments).output().unwrap().status.code(),
            Some(2),
            "{arguments:?}"
        );
    }
    for (flag, value, answer) in [
        ("--model", "both", "robust, paper"),
        ("--mode", "contact", "`--mode` is called `--model`"),
    ] {
        let run = stickslip()
            .args(["filter", &log, "--scene", &scene, flag, value])
            .output()
            .unwrap();
        assert_eq!(run.status.code(), Some(2));
        let error = String::from_utf8(run.stderr).unwrap();
        assert!(error.contains(answer), "{error}");
    }
}

#[test]
fn broken_files_are_named_with_line_and_column() {
    let case = Experiment::copy(STOP, "broken_files");
    let filter = || {
        stickslip()
            .args([
                "filter",
                &case.log(),
                "--scene",
                &case.scene(),
                "--method",
                "nominal",
            ])
            .output()
            .unwrap()
    };
    case.edit("scene.toml", |text| text.replace("mass = ", "mas = "));
    let run = filter();
    let talk = String::from_utf8(run.stderr).unwrap();
    assert_eq!(
        (run.status.code(), talk.lines().count()),
        (Some(1), 1),
        "{talk}"
    );
    assert!(
        talk.starts_with("error: ")
            && talk.contains("scene.toml:5:1: `object.mas` is not a known key"),
        "{talk}"
    );
    case.edit("scene.toml", |text| text.replace("mas = ", "mass = "));
    case.edit("log.csv", |text| {
        text.replacen("0.033333,", "0.033333,x", 1)
    });
    let talk = String::from_utf8(filter().stderr).unwrap();
    assert!(
        talk.contains("log.csv:3: column 2 (object_x): `x"),
        "{talk}"
    );
}

/// Runs the command with the reader of its results gone; with `Unread`, also the reader of its
/// errors.
fn unread(command: &mut Command, errors: Errors) -> Output {
    let closed = || {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        Stdio::from(writer)
    };
    command
        .stdout(closed())
        .stderr(if errors == Errors::Unread {
            closed()
        } else {
            Stdio::piped()
        });
    command.spawn().unwrap().wait_with_output().unwrap()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Errors {
    Read,
    Unread,
}

/// A panic would exit with 101 and leave a message on standard error.
#[test]
fn readers_that_leave_early_do_not_bring_a_command_down() {
    let good = Experiment::copy(STOP, "broken_pipe/good");
    let broken = Experiment::copy(STOP, "broken_pipe/broken");
    broken.edit("log.csv", |_| "time\n".to_owned());
    let (log, scene) = (good.log(), good.scene());
    let parent = good.folder.parent().unwrap().display().to_string();
    let figures = good.folder.join("figures");
    let commands: [(&[&str], i32); 8] = [
        (
            &[
                "demo",
                "--particles",
                "16",
                "--out",
                figures.to_str().unwrap(),
            ],
            0,
        ),
        (&["check", &scene, &log], 0),
        (&["check", &scene, &log, "--json"], 0),
        (
            &["filter", &log, "--scene", &scene, "--method", "nominal"],
            0,
        ),
        (
            &[
                "filter", &log, "--scene", &scene, "--method", "nominal", "--json",
            ],
            0,
        ),
        (&["compare", &parent, "--particles", "16"], 3),
        (&["--help"], 0),
        (&["filter", "no-such-log.csv", "--scene", &scene], 1),
    ];
    for (arguments, code) in commands {
        let run = unread(stickslip().args(arguments), Errors::Read);
        let talk = String::from_utf8(run.stderr).unwrap();
        assert_eq!(
            (run.status.code(), talk.contains("panicked")),
            (Some(code), false),
            "{arguments:?}: {talk}"
        );
        assert_eq!(
            unread(stickslip().args(arguments), Errors::Unread)
                .status
                .code(),
            Some(code),
            "{arguments:?}"
        );
    }
    assert!(
        figures.join("report.html").exists(),
        "files are written all the same"
    );
}

/// A full disk is a failure, other than a reader that has left.
#[test]
#[cfg(target_os = "linux")]
fn results_that_cannot_be_written_are_an_error() {
    let case = Experiment::copy(STOP, "full_disk");
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let run = stickslip()
        .args(["check", &case.scene(), &case.log()])
        .stdout(full)
        .output()
        .unwrap();
    let talk = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(1), "{talk}");
    assert!(
        talk.starts_with("error: standard output cannot be written: ") && talk.contains("\nhelp: "),
        "{talk}"
    );
}

#[test]
fn missing_files_come_with_the_next_step() {
    let run = stickslip()
        .args(["filter", "no-such-log.csv", "--scene", "no-such-scene.toml"])
        .output()
        .unwrap();
    let talk = String::from_utf8(run.stderr).unwrap();
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
    assert!(
        talk.contains("no-such-scene.toml") && talk.contains("\nhelp: "),
        "{talk}"
    );
}
