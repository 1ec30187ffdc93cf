//! Folders of bags in the program: found with their scene, read whole or in part.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{Experiment, STOP, json, stickslip};
use stickslip::Log;
use stickslip_formats::{Topics, read_estimate, read_log, write_log, write_log_mcap};

/// The rows of a log from `from` on up to `to`.
fn rows(log: &Log, from: usize, to: usize) -> Log {
    Log {
        time: log.time[from..to].to_vec(),
        object: log.object[from..to].to_vec(),
        object_covariance: Vec::new(),
        pusher: log.pusher[from..to].to_vec(),
        other_fingers: Vec::new(),
        tactile: log
            .tactile
            .iter()
            .map(|sensor| sensor[from..to].to_vec())
            .collect(),
        force: Vec::new(),
    }
}

/// An embedded experiment with its log as a bag of three files in a folder of its own.
fn experiment(test: &str) -> (Experiment, PathBuf) {
    let case = Experiment::copy(STOP, test);
    let (log, _) = read_log(fs::read(case.log()).unwrap().as_slice(), "log.csv").unwrap();
    let bag = case.folder.join("rosbag2_2026");
    fs::create_dir(&bag).unwrap();
    let ends = [0, 200, 400, log.len()];
    for (k, [from, to]) in ends.array_windows().enumerate() {
        let mut bytes = Cursor::new(Vec::new());
        write_log_mcap(&mut bytes, &rows(&log, *from, *to), &Topics::default()).unwrap();
        fs::write(
            bag.join(format!("rosbag2_2026_{k}.mcap")),
            bytes.into_inner(),
        )
        .unwrap();
    }
    let files = (0..3).map(|k| format!("  - rosbag2_2026_{k}.mcap\n"));
    let metadata = format!(
        "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths:\n{}  duration:\n    nanoseconds: 1\n",
        files.collect::<String>()
    );
    fs::write(bag.join("metadata.yaml"), metadata).unwrap();
    (case, bag)
}

fn filter(log: &Path) -> Output {
    let mut command = stickslip();
    command
        .arg("filter")
        .arg(log)
        .args(["--method", "kalman", "--json"]);
    command.output().unwrap()
}

fn words(run: &Output) -> String {
    String::from_utf8_lossy(&run.stderr).into_owned()
}

#[test]
fn bag_is_read_like_the_log_with_the_scene_and_the_truth_beside_it() {
    let (case, bag) = experiment("bags/like");
    let score = |log: &Path| {
        let run = filter(log);
        assert_eq!(run.status.code(), Some(0), "{}", words(&run));
        let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        (
            report["frames"].clone(),
            report["wmse_mm"].as_f64().unwrap(),
        )
    };
    let of_csv = score(&case.folder.join("log.csv"));
    let same = |(frames, wmse): (serde_json::Value, f64)| {
        frames == of_csv.0 && (wmse - of_csv.1).abs() < 1e-6 * of_csv.1
    };
    assert!(same(score(&bag)));
    assert!(same(score(&case.folder)), "a folder with a log");
    assert!(same(score(&bag.join("../log.csv"))));

    let check = |args: &[&Path]| stickslip().arg("check").args(args).output().unwrap();
    let both = check(&[
        &case.folder.join("scene.toml"),
        &case.folder.join("log.csv"),
    ]);
    assert_eq!(check(&[&case.folder]).stdout, both.stdout);
    assert_eq!(check(&[&bag]).stdout, both.stdout);

    // without a table, the folder's log is its only bag, and compare finds it too
    fs::remove_file(case.log()).unwrap();
    assert!(same(score(&case.folder)));
    let folder = case.folder.display().to_string();
    let compared = json(stickslip().args(["compare", &folder, "--json", "--particles", "16"]));
    assert_eq!(
        compared["folders"].as_array().unwrap().len(),
        1,
        "{compared}"
    );

    fs::remove_file(case.scene()).unwrap();
    let run = filter(&bag);
    assert_eq!(run.status.code(), Some(1));
    assert!(
        words(&run).contains("there is no scene.toml in it or next to it"),
        "{}",
        words(&run)
    );
}

#[test]
fn bag_without_all_of_its_files_is_done_with_input_lost() {
    let (case, bag) = experiment("bags/lost");
    fs::remove_file(case.log()).unwrap();
    let first = bag.join("rosbag2_2026_0.mcap");
    fs::remove_file(&first).unwrap();
    let run = filter(&bag);
    assert_eq!(run.status.code(), Some(3), "{}", words(&run));
    assert!(words(&run).contains("rosbag2_2026_0.mcap is not there; its messages are lost"));

    let last = bag.join("rosbag2_2026_2.mcap");
    let whole = fs::read(&last).unwrap();
    fs::write(&last, &whole[..whole.len() / 2]).unwrap();
    fs::remove_file(bag.join("metadata.yaml")).unwrap();
    let run = filter(&bag);
    assert_eq!(run.status.code(), Some(3), "{}", words(&run));
    let told = words(&run);
    assert!(told.contains("no metadata.yaml"), "{told}");
    assert!(
        told.contains("rosbag2_2026_2.mcap: the recording is cut off"),
        "{told}"
    );
}

#[test]
fn info_names_what_would_do_and_the_command_that_it_prints_runs() {
    let case = Experiment::copy(STOP, "bags/info");
    let (log, _) = read_log(fs::read(case.log()).unwrap().as_slice(), "log.csv").unwrap();
    let bag = case.folder.join("a bag");
    fs::create_dir(&bag).unwrap();
    let topics = [
        "object=/vicon/box/pose",
        "pusher=/arm/tool0",
        "fixel_1=/left/touch",
    ];
    let topics = Topics::new(topics.map(|text| text.parse().unwrap())).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    write_log_mcap(&mut bytes, &log, &topics).unwrap();
    fs::write(bag.join("bag_0.mcap"), bytes.into_inner()).unwrap();

    let info = json(stickslip().arg("info").arg(&bag).arg("--json"));
    assert_eq!(
        info["suggestion"],
        serde_json::json!([
            "object=/vicon/box/pose",
            "pusher=/arm/tool0",
            "fixel_1=/left/touch"
        ])
    );
    let topics = info["topics"].as_array().unwrap();
    let touch = topics
        .iter()
        .find(|topic| topic["name"] == "/left/touch")
        .unwrap();
    assert_eq!(
        (&touch["name"], &touch["message_type"], &touch["keys"]),
        (
            &"/left/touch".into(),
            &"std_msgs/msg/Bool".into(),
            &serde_json::json!(["fixel"])
        )
    );
    let measured = log.object.iter().flatten().count();
    assert_eq!(info["poses"][1]["poses"], measured, "{info}");

    // the command, taken apart by a shell, reads the bag like the table
    let command = info["commands"][0].as_str().unwrap();
    let program = env!("CARGO_BIN_EXE_stickslip");
    let command = command.replacen("stickslip", &format!("'{program}'"), 1);
    let run = std::process::Command::new("sh")
        .args(["-c", &command])
        .output()
        .unwrap();
    let of_table = stickslip()
        .args(["check", &case.scene(), &case.log()])
        .output()
        .unwrap();
    assert_eq!(run.stdout, of_table.stdout, "{command}: {}", words(&run));

    let text = stickslip().arg("info").arg(&bag).output().unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("Next steps:\n  stickslip check '"), "{text}");
    let table = stickslip().args(["info", &case.log()]).output().unwrap();
    assert!(
        words(&table).contains("this is no bag"),
        "{}",
        words(&table)
    );
}

#[test]
fn info_without_a_scene_says_how_to_come_by_one() {
    let (case, bag) = experiment("bags/no_scene");
    // the command puts it where the next ones look
    fs::remove_file(case.scene()).unwrap();
    let info = json(stickslip().args(["info", "--json"]).arg(&bag));
    let command = info["commands"][0].as_str().unwrap();
    assert!(command.starts_with("stickslip new "), "{command}");
    let command = command.replacen(
        "stickslip",
        &format!("'{}'", env!("CARGO_BIN_EXE_stickslip")),
        1,
    );
    let shell = std::process::Command::new("sh")
        .args(["-c", &command])
        .output()
        .unwrap();
    assert!(
        shell.status.success() && case.folder.join("scene.toml").is_file(),
        "{command}"
    );
}

#[test]
fn info_says_that_nothing_is_left_of_a_bag_cut_off_at_its_beginning() {
    let (_, bag) = experiment("bags/info_cut");
    let file = bag.join("rosbag2_2026_0.mcap");
    fs::write(&file, &fs::read(&file).unwrap()[..100]).unwrap();
    let run = stickslip().arg("info").arg(&file).output().unwrap();
    assert_eq!(run.status.code(), Some(3), "{}", words(&run));
    let text = String::from_utf8(run.stdout.clone()).unwrap();
    assert!(text.starts_with("No message can be read: "), "{text}");
}

#[test]
fn bag_that_was_reindexed_is_read_by_the_endings_of_its_files() {
    let (case, bag) = experiment("bags/reindexed");
    fs::remove_file(case.log()).unwrap();
    let metadata = fs::read_to_string(bag.join("metadata.yaml")).unwrap();
    for storage in ["\"\"", "~", "''"] {
        let reindexed = metadata.replace("_identifier: mcap", &format!("_identifier: {storage}"));
        assert_ne!(reindexed, metadata);
        fs::write(bag.join("metadata.yaml"), &reindexed).unwrap();
        let run = filter(&bag);
        assert_eq!(run.status.code(), Some(0), "{}", words(&run));
        let old = reindexed.replace(".mcap", ".db3");
        fs::write(bag.join("metadata.yaml"), old).unwrap();
        let run = filter(&bag);
        assert!(
            words(&run).contains("this is a bag in SQLite"),
            "{}",
            words(&run)
        );
    }
}

/// A camera at 30 Hz and a pusher at 5 Hz, each row with what was measured at its time.
fn two_rates(log: &Log) -> Log {
    let keeps = |row: usize| row % 6 == 1;
    let mut log = log.clone();
    for row in 0..log.len() {
        if keeps(row) {
            log.object[row] = None;
        } else {
            log.pusher[row] = None;
        }
    }
    log
}

#[test]
fn bag_and_table_of_the_same_measurements_give_the_same_estimate() {
    let case = Experiment::copy(STOP, "bags/rates");
    let (log, _) = read_log(fs::read(case.log()).unwrap().as_slice(), "log.csv").unwrap();
    let log = two_rates(&log);
    let (table, bag) = (
        case.folder.join("table.csv"),
        case.folder.join("rates.mcap"),
    );
    write_log(fs::File::create(&table).unwrap(), &log).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    write_log_mcap(&mut bytes, &log, &Topics::default()).unwrap();
    fs::write(&bag, bytes.into_inner()).unwrap();
    let estimate = |log: &Path| {
        let out = case.folder.join("out");
        let mut command = stickslip();
        command
            .arg("filter")
            .arg(log)
            .args(["--particles", "64", "--occlude", "200:"]);
        let run = command.arg("--out").arg(&out).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", words(&run));
        let bytes = fs::read(out.join("estimate.csv")).unwrap();
        read_estimate(bytes.as_slice(), "estimate.csv").unwrap()
    };
    let (of_table, of_bag) = (estimate(&table), estimate(&bag));
    assert_eq!(of_table.rows.len(), of_bag.rows.len());
    for (a, b) in of_table.rows.iter().zip(&of_bag.rows) {
        let apart = a
            .pose
            .zip(b.pose)
            .map_or(0.0, |(a, b)| (a.x - b.x).hypot(a.y - b.y));
        assert!(apart < 1e-6, "{apart}");
    }
}

#[test]
fn recording_of_two_runs_is_refused_and_read_in_parts() {
    let case = Experiment::copy(STOP, "bags/runs");
    let (log, _) = read_log(fs::read(case.log()).unwrap().as_slice(), "log.csv").unwrap();
    // a simulation that began again, recorded by the wall clock
    let bag = case.folder.join("runs");
    fs::create_dir(&bag).unwrap();
    for (k, late) in [10.0, 100.0].into_iter().enumerate() {
        let mut bytes = Cursor::new(Vec::new());
        write_log_mcap(&mut bytes, &log, &Topics::default()).unwrap();
        let bytes = with_log_times(&bytes.into_inner(), late);
        fs::write(bag.join(format!("runs_{k}.mcap")), bytes).unwrap();
    }
    let run = filter(&bag);
    assert_eq!(run.status.code(), Some(1));
    let told = words(&run);
    assert!(
        told.contains(
            "/object/pose, message 1 (log time 100.000000000 s): header.stamp jumps back"
        ),
        "{told}"
    );
    let help = told.lines().last().unwrap();
    let (to, from) = help.split_once(", or ").unwrap();
    let to = to.split_once("--to ").unwrap().1;
    let from = from.strip_prefix("--from ").unwrap();
    for part in [["--to", to], ["--from", from]] {
        let mut command = stickslip();
        command
            .arg("filter")
            .arg(&bag)
            .args(["--method", "kalman", "--json"]);
        let run = command.args(part).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{part:?} {}", words(&run));
        let result: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(result["frames"], log.len());
    }
    let swapped = stickslip()
        .arg("check")
        .arg(&bag)
        .args(["--to", "1", "--from", "2"])
        .output();
    assert_eq!(swapped.unwrap().status.code(), Some(2));
}

/// The messages of a recording with log times from `start` on (s).
fn with_log_times(bytes: &[u8], start: f64) -> Vec<u8> {
    let messages = mcap::MessageStream::new(bytes).unwrap();
    let messages: Vec<_> = messages.map(Result::unwrap).collect();
    let first = messages[0].log_time;
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    for message in messages {
        let log_time = message.log_time - first + (1e9 * start) as u64;
        let message = mcap::Message {
            log_time,
            publish_time: log_time,
            ..message
        };
        // touches have no other time
        if message.channel.topic.ends_with("/pose") {
            writer.write(&message).unwrap();
        }
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}
