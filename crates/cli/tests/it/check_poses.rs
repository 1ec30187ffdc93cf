//! `stickslip check` names poses that were lost, made up or frozen, and says nothing that is false
//! of rows without poses.

use crate::common::{Experiment, SLIDE, STOP, stickslip};
use stickslip_formats::{Topics, read_log, write_log_mcap};

/// Columns of the log.
const OBJECT: std::ops::Range<usize> = 1..4;
const PUSHER: std::ops::Range<usize> = 4..7;
const SENSOR: usize = 7;

/// Findings as "severity subject: what was found".
fn findings(case: &Experiment, log: &str) -> Vec<String> {
    let run = stickslip()
        .args(["check", &case.scene(), log, "--json"])
        .output()
        .unwrap();
    let report: serde_json::Value = serde_json::from_slice(&run.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&run.stderr)));
    let findings = report["findings"].as_array().unwrap().iter();
    let text = |finding: &serde_json::Value, key: &str| finding[key].as_str().unwrap().to_owned();
    findings
        .map(|f| {
            format!(
                "{} {}: {}",
                text(f, "severity"),
                text(f, "subject"),
                text(f, "found")
            )
        })
        .collect()
}

/// Checks that a finding for the changed log contains `words`.
#[track_caller]
fn assert_found(name: &str, test: &str, change: impl FnOnce(&mut Vec<Vec<f64>>), words: &str) {
    let case = Experiment::copy(name, &format!("check_poses/{test}"));
    case.edit_rows(change);
    let found = findings(&case, &case.log());
    assert!(
        found.iter().any(|text| text.contains(words)),
        "{words} in {found:#?}"
    );
}

#[test]
fn check_names_a_lost_pose_written_as_zeros() {
    let object = "problem object poses: the object is exactly at 0, 0, 0 in row 300";
    assert_found(
        SLIDE,
        "object_zero",
        |rows| rows[300][OBJECT].fill(0.0),
        object,
    );
    let pusher = "problem pusher poses: the pusher is exactly at 0, 0, 0 in row 30";
    assert_found(
        SLIDE,
        "pusher_zero",
        |rows| rows[30][PUSHER].fill(0.0),
        pusher,
    );
}

#[test]
fn check_names_a_jump() {
    let jump = |rows: &mut Vec<Vec<f64>>| rows[250..].iter_mut().for_each(|row| row[1] += 0.03);
    assert_found(
        SLIDE,
        "jump",
        jump,
        "problem object poses: the object jumps at row 250",
    );
}

#[test]
fn check_names_a_camera_that_stood_still() {
    let freeze = |rows: &mut Vec<Vec<f64>>| {
        let pose = rows[200][OBJECT].to_vec();
        rows[200..230]
            .iter_mut()
            .for_each(|row| row[OBJECT].copy_from_slice(&pose));
    };
    assert_found(
        SLIDE,
        "frozen",
        freeze,
        "warning repeated frames: rows 199 to 229 repeat one object pose",
    );
}

#[test]
fn check_names_a_sensor_that_never_reads_1() {
    let silence = |rows: &mut Vec<Vec<f64>>| rows.iter_mut().for_each(|row| row[SENSOR] = 0.0);
    assert_found(
        STOP,
        "silent",
        silence,
        "warning sensor 1: reads 1 in fewer than 5 rows, but fixel 1 is within",
    );
}

#[test]
fn check_names_a_pusher_that_is_missing_while_the_object_moves() {
    let lose = |rows: &mut Vec<Vec<f64>>| {
        rows[150..300]
            .iter_mut()
            .for_each(|row| row[PUSHER].fill(f64::NAN))
    };
    assert_found(
        SLIDE,
        "no_pusher",
        lose,
        "warning pusher poses: the pusher has no pose in rows 150 to 299",
    );
}

#[test]
fn check_tells_half_a_turn_from_a_wrapped_angle() {
    let flip = |rows: &mut Vec<Vec<f64>>| rows[200][3] += std::f64::consts::PI;
    assert_found(
        SLIDE,
        "flip",
        flip,
        "warning angles: object_theta jumps by half a turn at 2 rows, first at row 200",
    );
}

#[test]
fn check_of_empty_columns_speaks_of_no_infinity() {
    for (test, columns) in [("no_object", OBJECT), ("without_pusher", PUSHER)] {
        let case = Experiment::copy(STOP, &format!("check_poses/{test}"));
        case.edit_rows(|rows| {
            rows.iter_mut()
                .for_each(|row| row[columns.clone()].fill(f64::NAN))
        });
        let found = findings(&case, &case.log());
        assert!(
            !found
                .iter()
                .any(|text| text.contains("inf ") || text.contains("degrees")),
            "{found:#?}"
        );
    }
}

/// The pusher's poses come 7 ms after the camera's, so that no row has both.
#[test]
fn check_finds_the_same_in_a_bag_as_in_its_csv() {
    let case = Experiment::copy(STOP, "check_poses/bag");
    case.edit_rows(|rows| {
        for row in (3..rows.len()).rev() {
            let late = rows[row - 3][OBJECT].to_vec();
            rows[row][OBJECT].copy_from_slice(&late);
        }
    });
    case.edit("scene.toml", |text| {
        text.replace("\nposition_std = 0.000300\n", "\nposition_std = 0.00002\n")
    });
    let text = std::fs::read(case.log()).unwrap();
    let (log, _) = read_log(&text[..], "log.csv").unwrap();
    let rows = 2 * log.len();
    let every_other = |first: usize| move |row: usize| (row % 2 == first).then_some(row / 2);
    let (object, pusher) = (every_other(0), every_other(1));
    let apart = stickslip::Log {
        time: (0..rows)
            .map(|row| log.time[row / 2] + 0.007 * (row % 2) as f64)
            .collect(),
        object: (0..rows).map(|row| log.object[object(row)?]).collect(),
        pusher: (0..rows).map(|row| log.pusher[pusher(row)?]).collect(),
        ..stickslip::Log::default()
    };
    let bag = case.folder.join("apart.mcap");
    let mut bytes = std::io::Cursor::new(Vec::new());
    write_log_mcap(&mut bytes, &apart, &Topics::default()).unwrap();
    std::fs::write(&bag, bytes.into_inner()).unwrap();
    let found = findings(&case, &bag.display().to_string());
    let latency = found
        .iter()
        .find(|text| text.starts_with("problem latency: camera latency 0."));
    let delay: Option<f64> = latency.and_then(|text| text.split_whitespace().nth(4)?.parse().ok());
    assert!(
        delay.is_some_and(|delay| (delay - 0.1).abs() < 0.03),
        "{found:#?}"
    );
    assert!(
        found
            .iter()
            .any(|text| text.starts_with("warning noise: noise of object poses 0.3")),
        "{found:#?}"
    );
    assert!(
        found
            .iter()
            .any(|text| text.contains("the pusher is at the object whenever it moves")),
        "{found:#?}"
    );
}
