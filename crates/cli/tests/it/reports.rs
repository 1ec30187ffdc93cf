//! `compare`, `demo` and reports as a user gets them: exit codes, tables, files written.

use crate::common;
use std::fs;

use crate::common::{Experiment, STOP, stickslip, succeeds};

/// Few particles: these tests look at the program, not at the filter.
const FEW: [&str; 2] = ["--particles", "16"];

#[test]
fn compare_goes_on_after_a_broken_folder_and_exits_with_3() {
    let good = Experiment::copy(STOP, "compare_lost/good");
    let broken = Experiment::copy(STOP, "compare_lost/broken");
    broken.edit("log.csv", |_| "time\n".to_owned());
    // the parent folder stands for both
    let parent = good.folder.parent().unwrap();
    let run = stickslip()
        .arg("compare")
        .arg(parent)
        .args(["--json", "--seeds", "2"])
        .args(FEW)
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(3));
    assert!(
        String::from_utf8(run.stderr)
            .unwrap()
            .contains("broken/log.csv:1")
    );
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let methods: Vec<&str> = report["folders"][0]["methods"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| m["method"].as_str().unwrap())
        .collect();
    assert_eq!(
        methods,
        [
            "nominal",
            "kalman",
            "kalman_stops",
            "with_pusher",
            "extended_kalman",
            "particle_no_tactile",
            "particle",
            "kalman_camera_on",
            "extended_kalman_camera_on",
            "particle_always_on"
        ]
    );
    assert_eq!(report["errors"].as_array().unwrap().len(), 1);
    let overall = &report["sets"][0]["methods"][0];
    assert_eq!(
        overall["median"]["wmse_mm"],
        report["folders"][0]["methods"][0]["wmse_mm"]
    );
    // a simulation without a spread has no coverage; the particle filter's is a share
    assert!(overall["mean"]["covered_90"].is_null());
    let covered = report["folders"][0]["methods"][6]["covered_90"].as_f64();
    assert!(covered.is_some_and(|share| (0.0..=1.0).contains(&share)));
    let pit = report["sets"][0]["methods"][6]["mean"]["pit"].as_array();
    let shares = pit.unwrap().iter().map(|share| share.as_f64().unwrap());
    assert!((shares.sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(
        report["touch_gain"].is_null(),
        "one folder has no standard error"
    );
}

#[test]
fn compare_does_not_depend_on_threads() {
    let case = Experiment::copy(STOP, "compare_threads");
    let run = |threads: &str| {
        stickslip()
            .arg("compare")
            .arg(&case.folder)
            .args(["--threads", threads, "--json"])
            .args(FEW)
            .output()
            .unwrap()
            .stdout
    };
    let one = run("1");
    assert!(!one.is_empty() && one == run("3"));
}

#[test]
fn compare_of_nothing_but_broken_folders_fails() {
    let run = stickslip()
        .args(["compare", "no-such-folder"])
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(1));
    assert!(
        String::from_utf8(run.stderr)
            .unwrap()
            .contains("no-such-folder")
    );
}

#[test]
fn demo_prints_tables_and_writes_a_report_and_figures() {
    let folder = common::empty_folder("demo");
    let run = succeeds(stickslip().arg("demo").args(FEW).current_dir(&folder));
    let told = String::from_utf8(run.stdout).unwrap();
    let lines = [
        "particle filter without touch",
        "particle filter, camera on",
        "Kalman filter",
        "truth",
        "stickslip-demo/report.html",
    ];
    for line in lines {
        assert!(told.contains(line), "{line} is missing in\n{told}");
    }
    let file = |name: &str| {
        fs::read(folder.join("stickslip-demo").join(name))
            .unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    for experiment in ["turn-square-disc", "slide-pent-bar-97012"] {
        for figure in [
            "errors",
            "poses",
            "contacts",
            "friction",
            "cloud",
            "particles",
        ] {
            assert!(file(&format!("{experiment}-{figure}.svg")).starts_with(b"<svg"));
            #[cfg(feature = "png")]
            assert!(file(&format!("{experiment}-{figure}.png")).starts_with(b"\x89PNG"));
        }
    }
    let errors = String::from_utf8(file("turn-square-disc-errors.svg")).unwrap();
    assert!(
        errors.contains("position error (mm)")
            && errors.contains("fixel 1")
            && errors.contains("camera off")
    );
    let report = String::from_utf8(file("report.html")).unwrap();
    assert_eq!(
        report.matches("<section class=\"player\" tabindex").count(),
        2
    );
}

#[test]
fn filter_writes_a_report_and_the_same_estimate() {
    let case = Experiment::copy(STOP, "filter_report");
    let (page, plain, watched) = (
        case.folder.join("new/report.html"),
        case.folder.join("plain"),
        case.folder.join("watched"),
    );
    let filter = |out: &std::path::Path| {
        let mut command = stickslip();
        command
            .args([
                "filter",
                &case.log(),
                "--scene",
                &case.scene(),
                "--occlude",
                "153",
                "--out",
            ])
            .arg(out)
            .args(FEW);
        command
    };
    assert_eq!(filter(&plain).output().unwrap().status.code(), Some(0));
    succeeds(filter(&watched).arg("--report").arg(&page));
    let estimate = |folder: &std::path::Path| fs::read(folder.join("estimate.csv")).unwrap();
    assert!(
        estimate(&plain) == estimate(&watched),
        "a report changes no estimate"
    );
    let page = fs::read_to_string(page).unwrap();
    for text in [
        "class=\"player\"",
        "The camera turns off at 5.1 s, 0.2 s before the object touches a <abbr title=\"a fixed body",
        "<h1>filter_report: particle filter</h1>",
        "download=\"filter_report-estimate.csv\"",
        "--occlude 153",
        "<dt>seed</dt><dd>0</dd>",
        "Not identifiable from this push: ",
    ] {
        assert!(page.contains(text), "{text} is missing");
    }
    let unwritable = filter(&plain)
        .arg("--report")
        .arg(case.folder.join("log.csv/report.html"))
        .output()
        .unwrap();
    assert_eq!(unwritable.status.code(), Some(1));
}

#[test]
fn compare_writes_a_report_of_all_folders() {
    let case = Experiment::copy(STOP, "compare_report");
    let page = case.folder.join("report.html");
    succeeds(
        stickslip()
            .arg("compare")
            .arg(&case.folder)
            .arg("--report")
            .arg(&page)
            .args(FEW),
    );
    let page = fs::read_to_string(page).unwrap();
    for text in [
        "1 experiment, all variants on each: particle filters with",
        "with one seed",
        "All experiments",
        "class=\"player\"",
        "number 1 of 1 by the particle filter's pose RMSE",
        "compare_report",
        "particle filter without touch",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("particle, no tactile"), "one name for each");
}

/// Over several logs: a dot per log and method, and the worst logs lead to their players.
#[test]
fn compare_draws_logs_and_links_the_worst() {
    let names = ["first", "second", "third"].map(|name| format!("compare_pictures/{name}"));
    let [one, ..] = names.map(|name| Experiment::copy(STOP, &name));
    let parent = one.folder.parent().unwrap();
    let page = parent.join("report.html");
    succeeds(
        stickslip()
            .arg("compare")
            .arg(parent)
            .arg("--report")
            .arg(&page)
            .args(FEW),
    );
    let page = fs::read_to_string(page).unwrap();
    // errors of ten methods, ratios of nine, coverage of the nine with a spread; wide and narrow
    let dots = page.matches("<title>second: ").count();
    assert_eq!(dots, 2 * (10 + 9 + 9));
    for name in ["first", "second", "third"] {
        let (_, link) = page.split_once(&format!("href=\"#{name}-number-")).unwrap();
        let (rank, _) = link.split_once('"').unwrap();
        let place = format!("id=\"{name}-number-{rank}\"");
        let (_, section) = page.split_once(&place).unwrap();
        let (section, _) = section.split_once("</svg>").unwrap();
        assert!(section.contains("class=\"player\""), "{name}");
    }
}

/// A log's clock reads seconds since 1970; a page that counts from the log's start says from when.
#[test]
fn pages_of_compare_say_from_when_a_clocks_times_count() {
    let case = Experiment::copy(STOP, "compare_clock");
    let page = case.folder.join("report.html");
    let note = |case: &Experiment| {
        let mut command = stickslip();
        command.arg("compare").arg(&case.folder).args(FEW);
        succeeds(command.arg("--report").arg(&page));
        let text = fs::read_to_string(&page).unwrap();
        let from = text.split_once("Times count from ").map(|(_, rest)| rest);
        from.map(|rest| rest.split_once(" s of the log").unwrap().0.to_owned())
    };
    assert_eq!(note(&case), None);
    let shift = |rows: &mut Vec<Vec<f64>>| rows.iter_mut().for_each(|row| row[0] += 1.76e9);
    case.edit_rows(shift);
    let first = fs::read_to_string(case.log()).unwrap();
    let first: f64 = first
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    case.edit("truth.csv", |text| {
        let (header, rows) = text.split_once('\n').unwrap();
        let later = rows.lines().map(|row| {
            let (time, rest) = row.split_once(',').unwrap();
            format!("{},{rest}\n", time.parse::<f64>().unwrap() + 1.76e9)
        });
        format!("{header}\n{}", later.collect::<String>())
    });
    assert_eq!(note(&case), Some(first.floor().to_string()));
}

#[test]
fn compare_says_which_stall_force_it_assumes() {
    let case = Experiment::copy(STOP, "compare_no_stall_force");
    case.forget_stall_force();
    let page = case.folder.join("report.html");
    let compare = |options: &[&str]| {
        let mut command = stickslip();
        command.arg("compare").arg(&case.folder).args(FEW);
        String::from_utf8(command.args(options).output().unwrap().stdout).unwrap()
    };
    let text = compare(&["--report", page.to_str().unwrap()]);
    for told in [text, fs::read_to_string(page).unwrap()] {
        assert!(told.contains("32.0 N is assumed"), "{told}");
    }
    let report: serde_json::Value = serde_json::from_str(&compare(&["--json"])).unwrap();
    let folder = &report["folders"][0];
    assert_eq!(folder["stall_force_assumed"], true);
    assert!((folder["stall_force"].as_f64().unwrap() - 31.9826).abs() < 1e-3);
}

/// A log without touch sensors has no filter without touch: it is not pooled with logs that do.
#[test]
fn compare_sets_methods_side_by_side_on_equal_folders() {
    let felt = Experiment::copy(STOP, "compare_sets/felt");
    let unfelt = Experiment::copy(STOP, "compare_sets/unfelt");
    unfelt.edit("log.csv", |text| {
        let rows = text.lines().map(|row| row.split(',').collect::<Vec<_>>());
        let rows: Vec<Vec<&str>> = rows.collect();
        let kept = |k: &usize| !rows[0][*k].starts_with("tactile");
        let row = |row: &Vec<&str>| {
            let cells = (0..row.len()).filter(kept).map(|k| row[k]);
            cells.collect::<Vec<_>>().join(",") + "\n"
        };
        rows.iter().map(row).collect()
    });
    let run = stickslip()
        .arg("compare")
        .args([&felt.folder, &unfelt.folder])
        .arg("--json")
        .args(FEW)
        .output()
        .unwrap();
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let sets = report["sets"].as_array().unwrap();
    let counts = |key: &str| -> Vec<usize> {
        let of = sets.iter().map(|set| set[key].as_array().unwrap().len());
        of.collect()
    };
    // "stops at touch" and "no touch" need sensors
    assert_eq!(counts("folders"), [2, 1]);
    assert_eq!(counts("methods"), [8, 10]);
    let own = |folder: usize, method: usize| {
        report["folders"][folder]["methods"][method]["wmse_mm"]
            .as_f64()
            .unwrap()
    };
    let nominal = &sets[1]["methods"][0];
    let difference = nominal["difference"]["median_mm"].as_f64().unwrap();
    assert!((difference - (own(0, 0) - own(0, 6))).abs() < 1e-12);
    assert!(sets[1]["methods"][6]["difference"].is_null());
}
