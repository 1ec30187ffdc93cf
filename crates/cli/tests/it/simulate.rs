//! `stickslip simulate`: files that the other commands read, the same bytes twice, truth from
//! elsewhere, refusals.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{empty_folder, json, stickslip, succeeds};

const SCENE: &str = "gravity = 9.81
object = { mass = 0.5, inertia = 2.1e-4, shape = [{ polygon = [[-0.025, -0.025], [0.025, -0.025], [0.025, 0.025], [-0.025, 0.025]] }] }
support = { friction = 0.28, tripod_radius = 0.02 }
pusher = { friction = 0.30, shape = [{ disc = { radius = 0.005 } }], stall_force = 20 }
fixels = { friction = 0.25 }
fixel = [{ position = [0.06, 0.01], shape = [{ disc = { radius = 0.005 } }] }, { position = [0.0, 0.09], shape = [{ disc = { radius = 0.005 } }] }]
camera = { position_std = 3.0e-4, orientation_std = 5.2e-3 }
[start]
object = [0, 0, 0]
pusher = [-0.035, -0.003, 0]
speed = 0.02
duration = 4
";

/// A folder with the scene in it.
fn folder(name: &str, scene: &str) -> PathBuf {
    let folder = empty_folder(name);
    fs::write(folder.join("scene.toml"), scene).unwrap();
    folder
}

fn simulate(folder: &Path, out: &str, options: &[&str]) -> Command {
    let mut command = stickslip();
    command
        .arg("simulate")
        .arg(folder.join("scene.toml"))
        .arg("--out")
        .arg(folder.join(out))
        .args(options);
    command
}

fn facts(folder: &Path, out: &str) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join(out).join("truth.json")).unwrap()).unwrap()
}

#[test]
fn simulated_experiments_are_read_by_filter_and_by_check() {
    let folder = folder("simulate_read", SCENE);
    for physics in ["testbed", "model"] {
        let run = succeeds(&mut simulate(&folder, physics, &["--physics", physics]));
        let told = String::from_utf8(run.stdout).unwrap();
        assert!(
            told.contains("121 rows, 4.0 s")
                && told.contains("fixel 1 touches")
                && told.contains("d_tri"),
            "{told}"
        );

        let out = folder.join(physics);
        assert_eq!(fs::read_to_string(out.join("scene.toml")).unwrap(), SCENE);
        let (log, scene) = (out.join("log.csv"), out.join("scene.toml"));
        let report = json(
            stickslip()
                .arg("filter")
                .arg(&log)
                .arg("--scene")
                .arg(&scene)
                .args(["--method", "kalman", "--json"]),
        );
        assert_eq!(report["frames"], 121);
        let checked = json(stickslip().arg("check").arg(&scene).arg(&log).arg("--json"));
        assert_eq!(checked["problems"], 0, "{checked}");

        // it touches the pusher at once, and after 30 mm the first fixel
        let facts = facts(&folder, physics);
        let (pusher, fixel) = (
            facts["first_pusher_contact"].as_u64().unwrap(),
            facts["first_fixel_contacts"][0].as_u64().unwrap(),
        );
        assert!(
            (8..=12).contains(&pusher) && (50..=65).contains(&fixel),
            "{facts}"
        );
        assert!(facts["first_fixel_contacts"][1].is_null());
        assert_eq!(facts["occlude_from"].as_u64().unwrap(), fixel - 5);
    }
}

#[test]
fn simulation_gives_the_same_bytes_for_the_same_seed_only() {
    let folder = folder("simulate_seed", SCENE);
    for (out, seed) in [("a", "7"), ("b", "7"), ("c", "8")] {
        succeeds(&mut simulate(&folder, out, &["--seed", seed]));
    }
    let bytes = |out: &str| {
        ["log.csv", "truth.csv", "truth.json"]
            .map(|file| fs::read(folder.join(out).join(file)).unwrap())
    };
    assert!(bytes("a") == bytes("b"));
    assert!(bytes("a") != bytes("c"));
}

/// Compares the bytes of files in two folders.
fn same(one: &Path, other: &Path, files: &[&str]) -> bool {
    let read = |folder: &Path, file: &str| fs::read(folder.join(file)).unwrap();
    files
        .iter()
        .all(|file| read(one, file) == read(other, file))
}

#[test]
fn rig_seed_keeps_the_rig_and_noise_seed_the_noise() {
    // a fixel with a touch sensor, whose chatter is noise
    let folder = folder("simulate_seeds", SCENE);
    let drawn = ["--friction-error", "0.3"];
    for (out, seeds) in [
        ("plain", ["--seed", "7", "--rate", "30"]),
        ("same", ["--rig-seed", "7", "--noise-seed", "7"]),
        ("noise", ["--rig-seed", "7", "--noise-seed", "8"]),
        ("rig", ["--rig-seed", "8", "--noise-seed", "7"]),
    ] {
        succeeds(simulate(&folder, out, &seeds).args(drawn));
    }
    let at = |out: &str| folder.join(out);
    let all = ["log.csv", "truth.csv", "truth.json"];
    assert!(same(&at("plain"), &at("same"), &all));

    // another noise leaves the motion and the friction, another rig neither
    assert!(same(&at("plain"), &at("noise"), &["truth.csv"]));
    assert!(!same(&at("plain"), &at("noise"), &["log.csv"]));
    let [plain, noise, rig] = ["plain", "noise", "rig"].map(|out| facts(&folder, out));
    for key in ["mu_s", "mu_p", "mu_f", "d_tri"] {
        assert!(plain[key] == noise[key] && plain[key] != rig[key], "{key}");
    }
    // the error of a frame's camera is that of its noise seed
    let error = |out: &str| {
        let x = |file: &str| -> f64 {
            let text = fs::read_to_string(at(out).join(file)).unwrap();
            let cell = text.lines().nth(1).unwrap().split(',').nth(1).unwrap();
            cell.parse().unwrap()
        };
        x("log.csv") - x("truth.csv")
    };
    assert!((error("plain") - error("rig")).abs() < 1e-12);
    assert!((error("plain") - error("noise")).abs() > 1e-6);
}

#[test]
fn many_simulations_in_a_call_are_those_of_single_calls() {
    let folder = folder("simulate_count", SCENE);
    let seeds = ["--rig-seed", "3", "--noise-seed"];
    let many = ["11", "--count", "3"];
    succeeds(simulate(&folder, "many", &seeds).args(many));
    for noise in ["11", "12", "13"] {
        let out = format!("one-{noise}");
        succeeds(simulate(&folder, &out, &seeds).arg(noise));
        let many = folder.join("many").join(format!("noise-{noise}"));
        let files = ["scene.toml", "log.csv", "truth.csv", "truth.json"];
        assert!(same(&many, &folder.join(out), &files));
    }
    assert_eq!(fs::read_dir(folder.join("many")).unwrap().count(), 3);

    // a log that is there is found before anything is simulated
    let run = simulate(&folder, "many", &["--noise-seed", "13", "--count", "2"])
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(1));
    assert!(!folder.join("many/noise-14").exists());
}

#[test]
fn rate_and_truth_are_taken_where_they_are_given() {
    let folder = folder("simulate_truth", SCENE);
    fs::write(
        folder.join("known.json"),
        r#"{ "mu_s": 0.2, "mu_f": 0.4, "d_tri": 0.015, "occlude_from": 17 }"#,
    )
    .unwrap();
    let known = folder.join("known.json").display().to_string();
    succeeds(&mut simulate(
        &folder,
        "given",
        &["--truth", &known, "--rate", "60", "--physics", "model"],
    ));
    let given = facts(&folder, "given");
    assert_eq!(
        (
            given["mu_s"].as_f64(),
            given["mu_p"].as_f64(),
            given["d_tri"].as_f64()
        ),
        (Some(0.2), Some(0.3), Some(0.015))
    );
    assert_eq!(given["occlude_from"], 17);
    assert_eq!(
        fs::read_to_string(folder.join("given/log.csv"))
            .unwrap()
            .lines()
            .count(),
        1 + 241
    );

    succeeds(&mut simulate(
        &folder,
        "drawn",
        &["--friction-error", "0.4"],
    ));
    let drawn = facts(&folder, "drawn");
    let miss = |key: &str, nominal: f64| (drawn[key].as_f64().unwrap() / nominal - 1.0).abs();
    assert!(
        miss("mu_p", 0.3) < 0.4 && miss("mu_f", 0.25) < 0.4 && miss("mu_p", 0.3) > 1e-3,
        "{drawn}"
    );
}

#[test]
fn camera_that_the_scene_has_not_measures_exactly() {
    let folder = folder("simulate_exact", &SCENE.replace("camera = {", "# {"));
    succeeds(&mut simulate(&folder, "out", &[]));
    let column = |file: &str, k: usize| -> Vec<String> {
        let text = fs::read_to_string(folder.join("out").join(file)).unwrap();
        text.lines()
            .skip(1)
            .map(|line| line.split(',').nth(k).unwrap().to_owned())
            .collect()
    };
    assert_eq!(column("log.csv", 1), column("truth.csv", 1));
    assert_eq!(column("log.csv", 4), column("truth.csv", 7));
}

#[test]
fn what_cannot_be_simulated_is_refused_with_the_next_step() {
    let refused = |name: &str, scene: &str, options: &[&str], code: i32, words: &[&str]| {
        let run = simulate(&folder(name, scene), "out", options)
            .output()
            .unwrap();
        let talk = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(code), "{talk}");
        assert!(words.iter().all(|word| talk.contains(word)), "{talk}");
    };
    let (head, _) = SCENE.split_once("[start]").unwrap();
    refused(
        "simulate_no_start",
        head,
        &[],
        1,
        &["scene.toml", "no table [start]", "help: ", "duration"],
    );
    refused(
        "simulate_rigid",
        &SCENE.replace("stall_force = 20", "stall_force = inf"),
        &[],
        1,
        &[
            "scene.toml",
            "stall_force is inf",
            "help: ",
            "--physics model",
        ],
    );
    refused(
        "simulate_overlap",
        &SCENE.replace("-0.035", "-0.028"),
        &[],
        1,
        &["scene.toml", "overlaps the pusher by 2.000 mm", "[start]"],
    );
    refused(
        "simulate_rate",
        SCENE,
        &["--rate", "0"],
        2,
        &["--rate", "positive"],
    );
    refused(
        "simulate_fast",
        SCENE,
        &["--rate", "100000"],
        1,
        &["camera rate", "1000 Hz"],
    );
    refused(
        "simulate_long",
        &SCENE.replace("duration = 4", "duration = 1e300"),
        &[],
        1,
        &["start.duration is 1e300 s", "at most 1e4 s"],
    );
    refused(
        "simulate_share",
        SCENE,
        &["--friction-error", "40"],
        2,
        &["--friction-error", "from 0 to 1"],
    );
}

#[test]
fn scene_or_paper_experiment_is_needed_and_not_both() {
    let folder = folder("simulate_paper", SCENE);
    let simulate = |arguments: &[&str]| {
        let mut command = stickslip();
        command.arg("simulate").args(arguments);
        command.arg("--out").arg(folder.join("out"));
        command
    };
    let scene = folder.join("scene.toml").display().to_string();
    let bad: [&[&str]; 4] = [
        &[],
        &[&scene, "--paper", "A"],
        &["--paper", "C"],
        &["--paper", "A", "--friction-error", "0.1"],
    ];
    for arguments in bad {
        let run = simulate(arguments).output().unwrap();
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
    }
    let paper = succeeds(&mut simulate(&["--paper", "b"]));
    assert!(
        String::from_utf8(paper.stdout)
            .unwrap()
            .contains("ends on three")
    );
}

#[test]
fn log_that_is_there_is_not_written_over() {
    for name in ["log.csv", "log.mcap"] {
        let folder = folder(&format!("simulate_recorded/{name}"), SCENE);
        fs::write(folder.join(name), "recorded\n").unwrap();
        let run = simulate(&folder, ".", &[]).output().unwrap();
        let talk = String::from_utf8(run.stderr).unwrap();
        assert!(
            run.status.code() == Some(1) && talk.contains(name) && talk.contains("--out"),
            "{talk}"
        );
        assert_eq!(fs::read_to_string(folder.join(name)).unwrap(), "recorded\n");
        assert!(name == "log.csv" || !folder.join("log.csv").exists());
    }
}
