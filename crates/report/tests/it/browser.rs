//! The report in a real browser: no error, nothing loaded, moving the scrubber changes the drawing,
//! the occluded rows are shaded, the page fits a phone. Chromium prints the page after its scripts
//! have run, with a verdict that a script added here wrote into it.
//!
//! `cargo test -p stickslip-report --test it -- --ignored browser::`; the browser is `chromium`, or
//! the program that `STICKSLIP_CHROMIUM` names.

mod chromium;

use std::path::{Path, PathBuf};

use crate::common::{experiment, log, setup};
use chromium::chromium;
use serde_json::Value;
use stickslip_report::Report;

const BEFORE: &str = include_str!("browser/before.js");
const AFTER: &str = include_str!("browser/after.js");

/// A folder of this test.
fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn page() -> String {
    let (setup, log) = (setup(), log(200));
    let experiment = experiment("a grasp", &setup, &log, 60);
    Report {
        title: "A test of the report".to_owned(),
        sections: vec![experiment.section()],
        ..Report::default()
    }
    .to_html()
}

/// Chromium's print of a page, or the screenshot that it makes, at a width (px).
fn opened(page: &Path, width: u32, what: &str) -> String {
    // browsers that run at the same time may not share a profile
    let name = page.file_stem().unwrap().display();
    let profile = folder().join(format!("profile-{name}-{width}"));
    let address = format!("file://{}", page.display());
    chromium(&profile, &address, (width, 8000), &[what])
}

/// The page with the checks in it, as it ended.
fn verdict(width: u32) -> Value {
    let path = folder().join(format!("checked-{width}.html"));
    let checked = page().replacen("<head>", &format!("<head><script>{BEFORE}</script>"), 1);
    std::fs::write(
        &path,
        checked.replace("</body>", &format!("<script>{AFTER}</script></body>")),
    )
    .unwrap();
    let ended = opened(&path, width, "--dump-dom");
    let start = ended
        .find("<pre id=\"verdict\">")
        .unwrap_or_else(|| panic!("the checks came to no end"))
        + "<pre id=\"verdict\">".len();
    let length = ended[start..].find("</pre>").unwrap();
    serde_json::from_str(&ended[start..start + length]).unwrap()
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn the_report_works_in_a_browser() {
    let verdict = verdict(1280);
    for (check, result) in verdict.as_object().unwrap() {
        assert_eq!(result, &Value::Bool(true), "{check}: {verdict:#}");
    }
    assert!(verdict.as_object().unwrap().len() >= 12, "{verdict:#}");
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn the_report_fits_a_phone() {
    let verdict = verdict(400);
    for check in [
        "no trouble",
        "fits the width",
        "no figure is scrolled",
        "each figure is seen once, in letters to read",
    ] {
        assert_eq!(verdict[check], Value::Bool(true), "{check}: {verdict:#}");
    }
}

#[test]
#[ignore = "needs Chromium; .ci/run installs it and runs this"]
fn screenshots_are_made() {
    let path = folder().join("report.html");
    std::fs::write(&path, page()).unwrap();
    for width in [1280, 400] {
        let picture = folder().join(format!("report-{width}.png"));
        opened(&path, width, &format!("--screenshot={}", picture.display()));
        // a blank page takes a tenth of this
        assert!(
            std::fs::metadata(&picture).unwrap().len() > 60_000,
            "{}",
            picture.display()
        );
    }
}
