//! `stickslip reproduce`: the same bytes on any number of threads, its files, and arguments that it
//! refuses.

use std::fs;

use crate::common::{empty_folder, json, stickslip, succeeds};
use serde_json::Value;

/// A reproduction too small to mean anything.
fn small(seeds: &str) -> std::process::Command {
    let mut command = stickslip();
    command.args(["reproduce", "--seeds", seeds, "--particles", "8"]);
    command
}

fn names(rows: &Value, of: &str) -> Vec<String> {
    rows.as_array()
        .unwrap()
        .iter()
        .map(|row| row[of].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn reproduce_gives_the_same_bytes_on_one_and_two_threads() {
    let run = |threads: &str| succeeds(small("2").args(["--json", "--threads", threads]));
    let (one, two) = (run("1"), run("2"));
    assert!(one.stdout == two.stdout);
    let report: Value = serde_json::from_slice(&one.stdout).unwrap();
    assert_eq!(
        names(&report["tables"], "name"),
        ["Table II", "Table III", "Table IV"]
    );
    assert_eq!(
        names(&report["blackouts"], "experiment"),
        ["A", "B", "1", "2", "3", "4", "5", "6"]
    );
    // a row of five methods has ten pairs, and every band holds its median
    let row = &report["tables"][2]["rows"][0];
    assert_eq!(
        (
            row["cells"].as_array().unwrap().len(),
            row["orderings"].as_array().unwrap().len()
        ),
        (5, 10)
    );
    for order in row["orderings"].as_array().unwrap() {
        for of in [order, &order["dark_rows"], &order["camera_poses"]] {
            assert_eq!(of["finding"], "too_few_seeds", "{order}");
            assert!(of["difference_mm"].is_number() && of["standard_error_mm"].is_null());
        }
    }
    for cell in row["cells"].as_array().unwrap() {
        let [low, median, high] =
            ["low", "median", "high"].map(|of| cell["wmse_mm"][of].as_f64().unwrap());
        assert!(0.0 < low && low <= median && median <= high, "{cell}");
    }
}

#[test]
fn reproduce_writes_figures_tables_and_report() {
    let out = empty_folder("reproduce/files");
    let report = json(small("1").arg("--json").arg("--out").arg(&out));
    let written: Value =
        serde_json::from_str(&fs::read_to_string(out.join("reproduce.json")).unwrap()).unwrap();
    assert_eq!(report, written);
    for number in 2..=7 {
        assert!(
            fs::read_to_string(out.join(format!("fig{number}.svg")))
                .unwrap()
                .starts_with("<svg")
        );
        #[cfg(feature = "png")]
        assert!(
            fs::read(out.join(format!("fig{number}.png")))
                .unwrap()
                .starts_with(b"\x89PNG")
        );
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(
        [
            "Table II",
            "Table III",
            "Table IV",
            "Figure 7",
            "Experiment B",
            "Of 49 orders of the paper (occluded rows), 49 have too few seeds.",
            "Too few seeds to measure the gain by touch.",
            "stickslip reproduce --seeds 1 --particles 8"
        ]
        .iter()
        .all(|title| page.contains(title))
    );
}

#[test]
fn reproduce_runs_the_particle_filter_with_either_model_and_no_other_method() {
    let run = |model: &[&str]| json(small("1").arg("--json").args(model));
    let [paper, robust] = [run(&[]), run(&["--model", "robust"])];
    assert_eq!([&paper["model"], &robust["model"]], ["paper", "robust"]);
    let cells = |of: &Value| {
        of["tables"][2]["rows"][0]["cells"]
            .as_array()
            .unwrap()
            .clone()
    };
    let same: Vec<bool> = cells(&paper)
        .iter()
        .zip(cells(&robust))
        .map(|(paper, robust)| paper["wmse_mm"] == robust["wmse_mm"])
        .collect();
    // nominal simulation and Kalman filter, then three particle filters
    assert_eq!(same, [true, true, false, false, false]);
}

#[test]
fn reproduce_refuses_arguments_out_of_range_before_it_runs() {
    for bad in [
        ["--seeds", "0"],
        ["--particles", "0"],
        ["--threads", "0"],
        ["--seeds", "many"],
    ] {
        let run = stickslip().arg("reproduce").args(bad).output().unwrap();
        assert_eq!(run.status.code(), Some(2), "{bad:?}");
        assert!(
            run.stdout.is_empty() && String::from_utf8_lossy(&run.stderr).contains(bad[0]),
            "{bad:?}"
        );
    }
    let file = empty_folder("reproduce/file").join("file");
    fs::write(&file, "").unwrap();
    let run = stickslip()
        .args(["reproduce", "--out"])
        .arg(&file)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(1));
    assert!(
        said.contains("file: cannot be made") && said.contains("help: give a folder"),
        "{said}"
    );
}
