//! Recordings against two other programs, mcap-ros2-support and rosbags: they read our files, and
//! we read the files of rosbags.
//!
//! `cargo test -p stickslip-formats --test it -- --ignored ros2::`, with these Python packages
//! where `python3` finds them.

use std::f64::consts::TAU;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::data_folder::data_folder;
use crate::ros2_peer::{folder, peer};
use stickslip::{Log, PoseCovariance};
use stickslip_dynamics::Pose;
use stickslip_formats::{
    BagOptions, Mounts, Topics, read_bag, read_bag_metadata, read_log, write_log_mcap,
};

/// Recorded experiments; the last one has forces, and poses of a real camera.
const LOGS: [&str; 3] = [
    "mujoco/stop-square50-bar-000",
    "mujoco/slide-ell-disc-110",
    "real/zhou-tripod-push/hardboard_3pts_10-10_10-130_130-10_03",
];

/// Noise of poses in the script.
const TOLD: PoseCovariance = PoseCovariance {
    x: 1e-6,
    y: 1e-6 * 2.0,
    theta: 1e-6 * 6.0,
    x_y: 1e-7 / 2.0,
    x_theta: 1e-7 / 6.0,
    y_theta: 1e-7 / 7.0,
};

fn recorded(name: &str) -> (PathBuf, Log) {
    let path = data_folder().join(name).join("log.csv");
    let (log, _) = read_log(
        File::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())),
        "log.csv",
    )
    .unwrap();
    (path, log)
}

/// The log with a force in every third row, times far from 0 and some cells empty.
fn with_gaps(log: Log) -> Log {
    let rows = log.len();
    let time = log.time.iter().map(|time| time + 1_700_000_000.0).collect();
    let force = (0..rows)
        .map(|row| (row % 3 == 0).then_some([0.1 * row as f64, -1.0 / (1.0 + row as f64)]))
        .collect();
    let object = log
        .object
        .iter()
        .enumerate()
        .map(|(row, pose)| pose.filter(|_| row % 7 != 5))
        .collect();
    Log {
        time,
        force,
        object,
        ..log
    }
}

/// A message as both programs must read it.
#[derive(Debug, PartialEq)]
struct Line {
    topic: String,
    time: i64,
    stamped: bool,
    numbers: Vec<f64>,
}

fn expected(log: &Log) -> Vec<Line> {
    let mut lines = Vec::new();
    for row in 0..log.len() {
        let time = (log.time[row] * 1e9).round() as i64;
        let mut line = |topic: String, stamped: bool, numbers: Vec<f64>| {
            lines.push(Line {
                topic,
                time,
                stamped,
                numbers,
            })
        };
        let pose = |pose: Pose| {
            vec![
                pose.x,
                pose.y,
                0.0,
                0.0,
                0.0,
                libm::sin(pose.theta / 2.0),
                libm::cos(pose.theta / 2.0),
            ]
        };
        for (name, poses) in [("/object/pose", &log.object), ("/pusher/pose", &log.pusher)] {
            poses[row]
                .into_iter()
                .for_each(|at| line(name.to_owned(), true, pose(at)));
        }
        for (k, column) in (1..).zip(&log.tactile) {
            column[row].into_iter().for_each(|on| {
                line(
                    format!("/fixel_{k}/contact"),
                    false,
                    vec![f64::from(u8::from(on))],
                )
            });
        }
        if let Some(force) = log.force.get(row).copied().flatten() {
            line(
                "/pusher/wrench".to_owned(),
                true,
                vec![force[0], force[1], 0.0, 0.0, 0.0, 0.0],
            );
        }
    }
    lines
}

/// A line of `peer.py decode` without the program's name; the stamp and the frame are checked here.
fn parsed(words: &[&str]) -> Line {
    let [topic, time, stamp, frame, numbers @ ..] = words else {
        panic!("{words:?}")
    };
    let stamped = *stamp != "-";
    assert!(
        if stamped {
            (stamp, *frame) == (time, "world")
        } else {
            *frame == "-"
        },
        "{words:?}"
    );
    let numbers = numbers
        .iter()
        .map(|number| number.parse().unwrap())
        .collect();
    Line {
        topic: (*topic).to_owned(),
        time: time.parse().unwrap(),
        stamped,
        numbers,
    }
}

fn sorted(mut lines: Vec<Line>) -> Vec<Line> {
    lines.sort_by(|a, b| (a.time, &a.topic).cmp(&(b.time, &b.topic)));
    lines
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn others_read_what_is_written() {
    for name in LOGS {
        let log = with_gaps(recorded(name).1);
        let path = folder(&format!("written/{name}")).join("log.mcap");
        write_log_mcap(File::create(&path).unwrap(), &log, &Topics::default()).unwrap();
        let told = peer(&[Path::new("decode"), &path]);
        let expected = sorted(expected(&log));
        for program in ["mcap-ros2", "rosbags"] {
            let lines = told
                .lines()
                .map(|line| line.split(' ').collect::<Vec<_>>())
                .filter(|words| words[0] == program);
            let found = sorted(lines.map(|words| parsed(&words[1..])).collect());
            assert_eq!(found.len(), expected.len(), "{program}");
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found, expected, "{program}");
            }
        }
    }
}

/// The log of a bag's folder, by the names that its metadata has.
fn read_folder(bag: &Path, options: &BagOptions) -> Log {
    let metadata = fs::read_to_string(bag.join("metadata.yaml")).unwrap();
    let metadata = read_bag_metadata(&metadata, "metadata.yaml").unwrap();
    assert_eq!(metadata.storage_identifier, "mcap");
    let files = metadata.relative_file_paths.into_iter();
    let files = files.map(|name| (name.clone(), File::open(bag.join(name)).unwrap()));
    let (log, warnings) = read_bag(files, options).unwrap();
    assert_eq!(warnings, []);
    log
}

/// Asserts that a bag's log is that of the table, but for a pusher that is missing for a moment,
/// and is bridged; poses are the same within `tolerance`, angles to a full turn.
#[track_caller]
fn assert_same(read: &Log, log: &Log, tolerance: f64) {
    assert_eq!((read.len(), &read.tactile), (log.len(), &log.tactile));
    let mut times = read.time.iter().zip(&log.time);
    assert!(times.all(|(read, log)| (read - log).abs() <= 0.5e-9));
    let mut objects = read.object.iter().zip(&log.object);
    assert!(objects.all(|(read, log)| read.is_some() == log.is_some()));
    for (read, log) in [(&read.object, &log.object), (&read.pusher, &log.pusher)] {
        for (read, log) in read.iter().zip(log) {
            let Some(log) = log else { continue };
            let read = read.unwrap();
            let turn = (read.theta - log.theta) / TAU;
            let angle = (turn - turn.round()).abs();
            let aside = (read.x - log.x).abs() + (read.y - log.y).abs();
            assert!(
                aside <= tolerance && angle <= tolerance.max(1e-12),
                "{read:?} {log:?}"
            );
        }
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn others_read_covariances_that_are_written() {
    let (_, mut log) = recorded(LOGS[0]);
    log.object_covariance = (0..log.len())
        .map(|row| (row % 2 == 0).then_some(TOLD))
        .collect();
    let path = folder("covariances").join("log.mcap");
    write_log_mcap(File::create(&path).unwrap(), &log, &Topics::default()).unwrap();
    let told = peer(&[Path::new("estimate"), &path]);
    for program in ["ours", "humble"] {
        let lines = told.lines().map(|line| line.split(' ').collect::<Vec<_>>());
        let lines: Vec<_> = lines.filter(|words| words[0] == program).collect();
        assert_eq!(lines.len(), log.object.iter().flatten().count());
        let rows = (0..log.len()).filter(|row| log.object[*row].is_some());
        for (row, words) in rows.zip(lines) {
            let numbers: Vec<f64> = words[5..]
                .iter()
                .map(|word| word.parse().unwrap())
                .collect();
            let at = |i: usize, j: usize| numbers[4 + 6 * i + j];
            let found = PoseCovariance {
                x: at(0, 0),
                y: at(1, 1),
                theta: at(5, 5),
                x_y: at(1, 0),
                x_theta: at(5, 0),
                y_theta: at(1, 5),
            };
            assert_eq!(found, log.object_covariance[row].unwrap_or_default());
        }
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn what_others_write_is_read() {
    for name in LOGS {
        let (csv, log) = recorded(name);
        let bag = folder(&format!("read/{name}")).join("bag");
        peer(&[Path::new("record"), &csv, &bag]);
        let bytes = fs::read(bag.join("bag.mcap")).unwrap();
        let zstd = [0x28, 0xb5, 0x2f, 0xfd];
        assert!(
            bytes.windows(4).any(|window| window == zstd),
            "not packed with zstd"
        );
        let read = read_folder(&bag, &BagOptions::default());
        assert_eq!(read.force, log.force);
        assert_same(&read, &log, 0.0);
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn other_messages_of_others_are_read() {
    for name in LOGS {
        let (csv, log) = recorded(name);
        let bag = folder(&format!("kinds/{name}")).join("bag");
        peer(&[Path::new("kinds"), &csv, &bag]);
        let read = read_folder(&bag, &BagOptions::default());
        assert_same(&read, &log, 0.0);
        for (own, pose) in read.object_covariance.iter().zip(&log.object) {
            assert_eq!(*own, pose.map(|_| TOLD));
        }
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn transforms_of_others_are_read_through_camera_and_tags() {
    let mappings = [
        "object=/tf:table.tag_7",
        "object=/tf:table.tag36h11:8",
        "pusher=/tf:table.flange",
    ];
    let tags = [
        ("tag_7", Pose::new(0.012, -0.004, 1.5)),
        ("tag36h11:8", Pose::new(-0.02, 0.01, -0.5)),
    ];
    let options = BagOptions {
        topics: Topics::new(mappings.map(|text| text.parse().unwrap())).unwrap(),
        mounts: Mounts {
            object: tags.map(|(name, pose)| (name.to_owned(), pose)).into(),
            ..Mounts::default()
        },
        ..BagOptions::default()
    };
    for name in LOGS {
        let (csv, log) = recorded(name);
        let bag = folder(&format!("frames/{name}")).join("bag");
        peer(&[Path::new("frames"), &csv, &bag]);
        assert_same(&read_folder(&bag, &options), &log, 1e-12);
    }
}
