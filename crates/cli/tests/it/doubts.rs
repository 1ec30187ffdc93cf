//! A run whose scores mean nothing says so: in its text, its JSON and its page.

use std::fs;

use crate::common::{Experiment, SLIDE, STOP, json, stickslip};
use serde_json::Value;

/// Log and scene in millimetres: every camera pose is farther off than the scene's noise allows.
fn in_millimetres(test: &str) -> Experiment {
    let case = Experiment::copy(SLIDE, test);
    fs::remove_file(case.folder.join("truth.csv")).unwrap();
    fs::remove_file(case.folder.join("truth.json")).unwrap();
    case.edit_rows(|rows| {
        for row in rows {
            [1, 2, 4, 5].iter().for_each(|&k| row[k] *= 1e3);
        }
    });
    case
}

fn warnings(of: &Value) -> Vec<String> {
    let warnings = of["warnings"].as_array().unwrap().iter();
    warnings
        .map(|text| text.as_str().unwrap().to_owned())
        .collect()
}

fn has(warnings: &[String], words: &str) -> bool {
    warnings.iter().any(|text| text.contains(words))
}

#[test]
fn filter_says_when_nothing_was_explained() {
    let case = in_millimetres("doubts/filter");
    let page = case.folder.join("report.html");
    let arguments = ["--scene", &case.scene(), "--particles", "50", "--force"].map(str::to_owned);
    let filter = || {
        let mut command = stickslip();
        command.arg("filter").arg(case.log()).args(&arguments);
        command
    };
    let result = json(filter().arg("--json").arg("--report").arg(&page));
    let collapses = result["collapses"].as_u64().unwrap();
    assert!(collapses > 50, "{collapses}");
    let found = warnings(&result);
    assert!(
        has(&found, "millimetres") && has(&found, "small errors mean nothing"),
        "{found:?}"
    );

    let run = filter().output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(
        text.contains("warning: ")
            && text.contains("millimetres")
            && text.contains("small errors mean nothing"),
        "{text}"
    );
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("Warning: ") && page.contains("small errors mean nothing"));
}

#[test]
fn compare_says_when_nothing_was_explained() {
    let case = in_millimetres("doubts/compare");
    let compare = || {
        let mut command = stickslip();
        command
            .arg("compare")
            .arg(&case.folder)
            .args(["--particles", "50", "--force"]);
        command
    };
    let result = json(compare().arg("--json"));
    let found = warnings(&result["folders"][0]);
    assert!(
        has(&found, "millimetres") && has(&found, "small errors mean nothing"),
        "{found:?}"
    );
    let methods = result["folders"][0]["methods"].as_array().unwrap();
    let most = methods
        .iter()
        .map(|method| method["collapses"].as_u64().unwrap())
        .max();
    assert!(most.unwrap() > 50, "{most:?}");
    let text = String::from_utf8(compare().output().unwrap().stdout).unwrap();
    assert!(
        text.contains("warning: ") && text.contains("collapses"),
        "{text}"
    );
}

#[test]
fn good_experiments_raise_no_doubt() {
    for name in [STOP, SLIDE] {
        let case = Experiment::copy(name, &format!("doubts/good/{name}"));
        let result =
            json(stickslip().args(["filter", &case.log(), "--scene", &case.scene(), "--json"]));
        assert_eq!(warnings(&result), Vec::<String>::new());
        let run = stickslip()
            .args(["filter", &case.log(), "--scene", &case.scene()])
            .args(["--particles", "50"])
            .output();
        assert_eq!(String::from_utf8(run.unwrap().stderr).unwrap(), "");
    }
}

#[test]
fn compare_refuses_an_occlusion_that_hides_nothing_or_all() {
    let case = Experiment::copy(SLIDE, "doubts/occlusion");
    fs::remove_file(case.folder.join("truth.json")).unwrap();
    let compare = |rows: &str| {
        let mut command = stickslip();
        command
            .arg("compare")
            .arg(&case.folder)
            .args(["--particles", "20", "--occlude", rows]);
        command.output().unwrap()
    };
    for (rows, said) in [
        ("100000:", "hides no object pose"),
        ("0", "one is needed to start from"),
    ] {
        let run = compare(rows);
        let talk = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(1), "{talk}");
        assert!(talk.contains(said), "{talk}");
    }
    assert_eq!(compare("100:").status.code(), Some(0));
}

#[test]
fn compare_hides_what_it_is_told_to_rather_than_what_the_truth_says() {
    let case = Experiment::copy(SLIDE, "doubts/told");
    let rows = |occlude: &[&str]| {
        let mut command = stickslip();
        command
            .arg("compare")
            .arg(&case.folder)
            .args(["--particles", "20", "--json"])
            .args(occlude);
        let result = json(&mut command);
        let kalman = &result["folders"][0]["methods"][1];
        kalman["wmse_mm"].as_f64().unwrap()
    };
    // a few occluded rows are nothing to a Kalman filter, all that truth.json hides are
    assert!(rows(&["--occlude", "300:303"]) < 2.0);
    assert!(rows(&[]) > 20.0);
}
