//! Mistakes of newcomers: one cause is named, nothing else, and `filter` refuses what is surely
//! meaningless.

use serde_json::Value;

use crate::common::{Experiment, SLIDE, STOP, stickslip};

const OBJECT: std::ops::Range<usize> = 1..4;
const PUSHER: std::ops::Range<usize> = 4..7;

/// Findings of `check` that are no "ok", as "severity subject: found".
fn findings(case: &Experiment) -> Vec<String> {
    let run = stickslip()
        .args(["check", &case.scene(), &case.log(), "--json"])
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    let all = report["findings"].as_array().unwrap().iter();
    let shown = |finding: &Value| {
        let text = |key: &str| finding[key].as_str().unwrap().to_owned();
        format!(
            "{} {}: {}",
            text("severity"),
            text("subject"),
            text("found")
        )
    };
    all.filter(|finding| finding["severity"] != "ok")
        .map(shown)
        .collect()
}

/// Exit code and standard error of `filter` with more arguments.
fn filter(case: &Experiment, more: &[&str]) -> (Option<i32>, String) {
    let run = stickslip()
        .args(["filter", &case.log(), "--scene", &case.scene()])
        .args(["--method", "nominal"])
        .args(more)
        .output()
        .unwrap();
    (run.status.code(), String::from_utf8(run.stderr).unwrap())
}

/// One problem with these words, which `filter` refuses unless it is forced.
#[track_caller]
fn assert_refused(case: &Experiment, words: &[&str]) {
    let found = findings(case);
    let [only] = &found[..] else {
        panic!("{found:#?}");
    };
    assert!(words.iter().all(|word| only.contains(word)), "{only}");
    let (code, talk) = filter(case, &[]);
    assert!(code == Some(1) && talk.contains("--force"), "{talk}");
    assert!(
        words.last().is_some_and(|word| talk.contains(word)),
        "{talk}"
    );
    assert_eq!(filter(case, &["--force"]).0, Some(0));
}

#[test]
fn log_in_millimetres_is_refused_with_one_cause() {
    let case = Experiment::copy(SLIDE, "newcomer/log_mm");
    case.edit_rows(|rows| {
        let scaled = |row: &mut Vec<f64>| [1, 2, 4, 5].iter().for_each(|&k| row[k] *= 1e3);
        rows.iter_mut().for_each(scaled);
    });
    assert_refused(&case, &["problem units", "millimetres"]);
}

#[test]
fn noise_in_millimetres_or_degrees_is_refused() {
    for (name, from, to, unit) in [
        (
            "mm",
            "position_std = 0.000300",
            "position_std = 0.3",
            "in mm",
        ),
        (
            "degrees",
            "orientation_std = 0.005236",
            "orientation_std = 0.3",
            "in degrees",
        ),
    ] {
        let case = Experiment::copy(SLIDE, &format!("newcomer/noise_{name}"));
        case.edit("scene.toml", |text| text.replacen(from, to, 1));
        assert_refused(&case, &["problem noise", unit]);
    }
}

#[test]
fn x_and_y_swapped_in_both_bodies_is_refused() {
    let case = Experiment::copy(SLIDE, "newcomer/xy");
    case.edit_rows(|rows| {
        rows.iter_mut().for_each(|row| {
            row.swap(1, 2);
            row.swap(4, 5);
        });
    });
    let found = findings(&case);
    let named = found.iter().any(|line| line.starts_with("problem frames"));
    assert!(named, "{found:#?}");
    assert_eq!(filter(&case, &[]).0, Some(1));
}

#[test]
fn columns_of_object_and_pusher_swapped_is_refused() {
    for name in [STOP, SLIDE] {
        let case = Experiment::copy(name, &format!("newcomer/columns_{name}"));
        case.edit_rows(|rows| {
            for row in rows {
                OBJECT.zip(PUSHER).for_each(|(a, b)| row.swap(a, b));
            }
        });
        assert_refused(&case, &["problem frames", "object and pusher are swapped"]);
    }
}

#[test]
fn angles_of_a_scene_in_degrees_are_refused() {
    for (place, text) in [
        ("fixel.angle", "[[fixel]]\nangle = 90.0"),
        (
            "start.direction",
            "[start]\nobject = [0, 0, 0]\npusher = [-0.1, 0, 0]\nspeed = 0.02\nduration = 1\ndirection = 45.0\n\n[[fixel]]",
        ),
    ] {
        let case = Experiment::copy(SLIDE, &format!("newcomer/{place}"));
        case.edit("scene.toml", |scene| scene.replacen("[[fixel]]", text, 1));
        let (code, talk) = filter(&case, &[]);
        assert_eq!(code, Some(1), "{place}");
        assert!(talk.contains(place) && talk.contains("pi / 180"), "{talk}");
    }
}

#[test]
fn fixels_without_a_sensor_are_noted() {
    let case = Experiment::copy(SLIDE, "newcomer/one_sensor");
    case.edit("log.csv", |text| {
        let cut = |line: &str| line.split(',').take(8).collect::<Vec<_>>().join(",");
        text.lines().map(cut).collect::<Vec<_>>().join("\n") + "\n"
    });
    let run = stickslip()
        .args(["check", &case.scene(), &case.log()])
        .output()
        .unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(
        text.contains("the log has 1 sensor, the scene 3 fixels: sensor k is on the k-th fixel"),
        "{text}"
    );
}

#[test]
fn log_without_contact_is_named() {
    let case = Experiment::copy(SLIDE, "newcomer/no_contact");
    // the rows before the pusher arrives
    case.edit_rows(|rows| rows.truncate(40));
    let found = findings(&case);
    assert!(
        matches!(&found[..], [only] if only.starts_with("warning contact: nothing touches the object")),
        "{found:#?}"
    );
    let run = stickslip()
        .args([
            "filter",
            &case.log(),
            "--scene",
            &case.scene(),
            "--particles",
            "50",
        ])
        .output()
        .unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(text.contains("nothing touches the object"), "{text}");
}

#[test]
fn truth_on_another_clock_is_refused() {
    let case = Experiment::copy(SLIDE, "newcomer/clock");
    case.edit("truth.csv", |text| {
        let late = |(k, line): (usize, &str)| match line.split_once(',') {
            Some((time, rest)) if k > 0 => {
                format!("{},{rest}", time.parse::<f64>().unwrap() + 1e6)
            }
            _ => line.to_owned(),
        };
        text.lines()
            .enumerate()
            .map(late)
            .collect::<Vec<_>>()
            .join("\n")
            + "\n"
    });
    let (code, talk) = filter(&case, &[]);
    assert!(
        code == Some(1) && talk.contains("no time in common"),
        "{talk}"
    );
}
