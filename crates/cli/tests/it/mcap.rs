//! MCAP logs in the program: read wherever a log is, topics by name, exit codes.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::process::Output;

use crate::common::{Experiment, STOP, json, stickslip};
use stickslip_formats::{Topics, read_log, write_log_mcap};

/// An embedded experiment whose log is also a recording with these topics.
fn experiment(test: &str, mappings: &[&str]) -> (Experiment, PathBuf) {
    let case = Experiment::copy(STOP, test);
    let (log, _) = read_log(fs::read(case.log()).unwrap().as_slice(), "log.csv").unwrap();
    let mut bytes = Cursor::new(Vec::new());
    write_log_mcap(
        &mut bytes,
        &log,
        &Topics::new(mappings.iter().map(|text| text.parse().unwrap())).unwrap(),
    )
    .unwrap();
    let path = case.folder.join("log.mcap");
    fs::write(&path, bytes.into_inner()).unwrap();
    (case, path)
}

fn words(run: &Output) -> String {
    String::from_utf8_lossy(&run.stderr).into_owned()
}

#[test]
fn filter_compare_and_check_read_a_recording_like_the_log() {
    let (case, mcap) = experiment("mcap_like", &[]);
    let score = |log: &str| {
        json(stickslip().args([
            "filter",
            log,
            "--scene",
            &case.scene(),
            "--method",
            "kalman",
            "--json",
        ]))
    };
    let (of_csv, of_mcap) = (score(&case.log()), score(&mcap.display().to_string()));
    assert_eq!(of_csv["frames"], of_mcap["frames"]);
    let wmse = |report: &serde_json::Value| report["wmse_mm"].as_f64().unwrap();
    assert!(
        (wmse(&of_csv) - wmse(&of_mcap)).abs() < 1e-6 * wmse(&of_csv),
        "{of_csv} {of_mcap}"
    );

    let check = |log: &str| {
        stickslip()
            .args(["check", &case.scene(), log])
            .output()
            .unwrap()
    };
    assert_eq!(
        check(&case.log()).stdout,
        check(&mcap.display().to_string()).stdout
    );

    fs::remove_file(case.log()).unwrap();
    let compared =
        json(
            stickslip()
                .arg("compare")
                .arg(&case.folder)
                .args(["--json", "--particles", "16"]),
        );
    assert_eq!(
        compared["folders"].as_array().unwrap().len(),
        1,
        "{compared}"
    );
}

#[test]
fn topics_are_named_on_the_command_line() {
    let (case, mcap) = experiment("mcap_topics", &["object=/vicon/box/pose", "fixel_1=/touch"]);
    let check = |log: &str, topics: &[&str]| {
        let topics = topics.iter().flat_map(|topic| ["--topic", topic]);
        stickslip()
            .args(["check", &case.scene(), log])
            .args(topics)
            .output()
            .unwrap()
    };
    let mcap = mcap.display().to_string();
    let unnamed = check(&mcap, &[]);
    assert_eq!(unnamed.status.code(), Some(1));
    assert!(
        words(&unnamed).contains("the topic `/object/pose` (object) is not there"),
        "{}",
        words(&unnamed)
    );
    assert!(
        words(&unnamed).contains("help: name it with --topic object=TOPIC"),
        "{}",
        words(&unnamed)
    );
    let named = check(&mcap, &["object=/vicon/box/pose", "fixel_1=/touch"]);
    assert_eq!(
        named.stdout,
        check(&case.log(), &[]).stdout,
        "{}",
        words(&named)
    );

    for (topics, code, told) in [
        (&["object"][..], 2, "`object` has no `=`"),
        (
            &["object=/a", "object=/b"],
            2,
            "object is mapped to `/a` and to `/b`",
        ),
        (&["object=/a", "pusher=/a"], 2, "are both mapped to `/a`"),
    ] {
        let run = check(&mcap, topics);
        assert!(
            run.status.code() == Some(code) && words(&run).contains(told),
            "{}",
            words(&run)
        );
    }
    let csv = check(&case.log(), &["object=/a"]);
    assert!(
        csv.status.code() == Some(1) && words(&csv).contains("topics are for MCAP logs"),
        "{}",
        words(&csv)
    );
}

#[test]
fn recording_that_was_cut_off_is_done_with_input_lost() {
    let (case, mcap) = experiment("mcap_cut_off", &[]);
    let whole = fs::read(&mcap).unwrap();
    fs::write(&mcap, &whole[..whole.len() / 2]).unwrap();
    let log = mcap.display().to_string();
    let filter = stickslip()
        .args([
            "filter",
            &log,
            "--scene",
            &case.scene(),
            "--method",
            "kalman",
            "--json",
        ])
        .output()
        .unwrap();
    assert_eq!(filter.status.code(), Some(3), "{}", words(&filter));
    assert!(
        words(&filter).starts_with(&format!(
            "warning: {log}: the recording is cut off or damaged after "
        )),
        "{}",
        words(&filter)
    );
    let report: serde_json::Value = serde_json::from_slice(&filter.stdout).unwrap();
    assert!(report["frames"].as_u64().unwrap() > 50, "{report}");

    fs::remove_file(case.log()).unwrap();
    let compare = stickslip()
        .arg("compare")
        .arg(&case.folder)
        .args(["--particles", "16"])
        .output()
        .unwrap();
    assert_eq!(compare.status.code(), Some(3), "{}", words(&compare));

    fs::write(&mcap, "time\n").unwrap();
    let none = stickslip()
        .args(["filter", &log, "--scene", &case.scene()])
        .output()
        .unwrap();
    assert_eq!(none.status.code(), Some(1));
    assert!(
        words(&none).contains(
            "log.mcap: the file begins with the bytes 74 69 6D 65 0A, an MCAP recording with"
        ),
        "{}",
        words(&none)
    );
}
