//! A bag of images that another program wrote, rosbags, is tracked as the same frames as files are.
//!
//! `cargo test -p stickslip-cli --test it -- --ignored ros2::`, with that Python package where
//! `python3` finds it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{Experiment, SLIDE, json, stickslip, succeeds};

/// Frames that are rendered.
const FRAMES: usize = 8;

/// An experiment's frames with the calibration of their camera.
fn rendered(name: &str) -> PathBuf {
    let case = Experiment::copy(SLIDE, name);
    for file in ["log.csv", "truth.csv"] {
        case.edit(file, |text| {
            let lines: Vec<&str> = text.lines().collect();
            [&lines[..1], &lines[101..101 + FRAMES]].concat().join("\n") + "\n"
        });
    }
    let out = case.folder.join("out");
    let mut render = stickslip();
    render.arg("render").arg(&case.folder).args([
        "--board-frames",
        "8",
        "--repeat",
        "0.2",
        "--out",
    ]);
    succeeds(render.arg(&out));
    let mut calibrate = stickslip();
    calibrate
        .arg("calibrate")
        .arg(out.join("board"))
        .arg("--board")
        .arg(out.join("board.toml"));
    succeeds(calibrate.arg("--out").arg(out.join("calibration.toml")));
    out
}

/// A bag of a folder's frames, by rosbags.
fn bag(frames: &Path, calibration: &Path, bag: &Path) {
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../formats/tests/it/ros2_peer/peer.py");
    succeeds(
        Command::new("python3")
            .arg(script)
            .arg("images")
            .args([frames, calibration, bag]),
    );
}

/// Tracks frames or a bag of them.
fn track(rendered: &Path, frames: &Path, topics: &[&str], out: &Path) -> Output {
    let mut command = stickslip();
    command.arg("track").arg(frames);
    topics.iter().for_each(|topic| {
        command.args(["--topic", topic]);
    });
    command
        .arg("--calibration")
        .arg(rendered.join("calibration.toml"));
    command
        .arg("--tags")
        .arg(rendered.join("tags.toml"))
        .arg("--out")
        .arg(out);
    succeeds(&mut command)
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn a_bag_of_images_gives_the_poses_of_the_same_files() {
    let out = rendered("ros2/images");
    bag(
        &out.join("frames"),
        &out.join("calibration.toml"),
        &out.join("bag"),
    );
    track(&out, &out.join("frames"), &[], &out.join("of_files"));
    let poses = fs::read_to_string(out.join("of_files/poses.csv")).unwrap();
    assert!(
        poses.matches("measured").count() > 2 * FRAMES - 4,
        "{poses}"
    );
    assert!(
        poses.lines().any(|line| line.contains(",1,measured")),
        "no frame repeats: {poses}"
    );
    for image in [
        "/cam/image_raw/compressed",
        "/cam/image_raw",
        "/colour/image_raw",
        "/deep/image_raw",
    ] {
        let tracked = out.join(image.replace('/', "_"));
        let said = track(
            &out,
            &out.join("bag"),
            &[&format!("image={image}")],
            &tracked,
        );
        assert_eq!(
            fs::read_to_string(tracked.join("poses.csv")).unwrap(),
            poses,
            "{image}"
        );
        assert!(
            !String::from_utf8_lossy(&said.stderr).contains("warning"),
            "{image}"
        );
        // the log has the touches of the bag, one row each
        let log = fs::read_to_string(tracked.join("log.csv")).unwrap();
        let files = fs::read_to_string(out.join("of_files/log.csv")).unwrap();
        for (k, (of_bag, of_files)) in log.lines().zip(files.lines()).skip(1).enumerate() {
            assert_eq!(of_bag, format!("{of_files},{}", u8::from(k % 3 == 0)));
        }
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn the_bags_own_suggestion_leads_to_a_log() {
    let out = rendered("ros2/suggestion");
    bag(
        &out.join("frames"),
        &out.join("calibration.toml"),
        &out.join("bag"),
    );
    let info = json(stickslip().arg("info").arg(out.join("bag")).arg("--json"));
    let command = info["image_commands"][0].as_str().unwrap();
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    assert!(words.contains(&"image=/cam/image_raw"), "{command}");
    succeeds(stickslip().args(words).current_dir(&out));
    assert!(out.join("tracked/log.csv").is_file());
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn a_bag_of_the_board_gives_the_table_through_its_own_lens() {
    let out = rendered("ros2/board");
    let frames = out.join("board");
    let listed: Vec<String> = (0..8).map(|k| format!("{k}.5,{k:03}.png")).collect();
    fs::write(
        frames.join("frames.csv"),
        format!("time,file\n{}\n", listed.join("\n")),
    )
    .unwrap();
    bag(&frames, &out.join("calibration.toml"), &out.join("bag"));
    // rosbags wrote the latest frame first, so the flat one is the last
    let mut command = stickslip();
    command.arg("calibrate").arg(out.join("bag")).args([
        "--topic",
        "image=/cam/image_raw",
        "--flat",
        "8",
    ]);
    command
        .arg("--board")
        .arg(out.join("board.toml"))
        .arg("--out")
        .arg(out.join("table.toml"));
    let of_bag = json(command.arg("--json"));
    let mut command = stickslip();
    command
        .arg("calibrate")
        .arg(&frames)
        .arg("--lens")
        .arg(out.join("calibration.toml"));
    command
        .arg("--board")
        .arg(out.join("board.toml"))
        .arg("--out")
        .arg(out.join("again.toml"));
    let of_files = json(command.arg("--json"));
    assert_eq!(of_bag, of_files);
    let [table, again] = ["table.toml", "again.toml"].map(|name| fs::read(out.join(name)).unwrap());
    assert_eq!(table, again);
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn a_bag_of_the_board_gives_the_lens_where_no_camera_info_does() {
    let out = rendered("ros2/lens");
    let frames = out.join("board");
    let listed: Vec<String> = (0..8).map(|k| format!("{k}.5,{k:03}.png")).collect();
    let list = format!("time,file\n{}\n", listed.join("\n"));
    fs::write(frames.join("frames.csv"), list).unwrap();
    bag(&frames, &out.join("calibration.toml"), &out.join("bag"));
    // those that are in the bag
    for k in 8.. {
        if fs::remove_file(frames.join(format!("{k:03}.png"))).is_err() {
            break;
        }
    }
    let calibrated = |from: &str, options: &[&str]| {
        let mut command = stickslip();
        command.arg("calibrate").arg(out.join(from)).args(options);
        command.arg("--board").arg(out.join("board.toml"));
        json(command.arg("--out").arg(out.join("of.toml")).arg("--json"))
    };
    // rosbags wrote the latest frame first, so the flat one is the last
    let topics = ["--topic", "image=/cam/image_raw", "--topic", "info="];
    let of_bag = calibrated("bag", &[&topics[..], &["--flat", "8"]].concat());
    let of_files = calibrated("board", &[]);
    for key in ["frames", "tags", "tags_left_out"] {
        assert_eq!(of_bag[key], of_files[key], "{key}");
    }
    for k in 0..8 {
        let [a, b] = [&of_bag, &of_files].map(|of| of["lens"][k].as_f64().unwrap());
        assert!((a - b).abs() < 1e-6 * b.abs(), "{k}: {a} {b}");
    }
}
