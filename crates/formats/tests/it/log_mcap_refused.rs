//! MCAP recordings: every kind of bad input at its place, damaged files, and refusals when writing.

use std::io::Cursor;

use crate::bag::{
    BOOL, Line, MS, Order, POSE, file, file_with, object, pose, pusher, read, stamped, topics,
    touch, wrench, xs,
};
use mcap::Compression;
use proptest::prelude::*;
use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{Topics, read_log_mcap, write_log_mcap};

#[track_caller]
fn refused(lines: &[Line], topics: &Topics, words: &str) {
    let message = read_log_mcap(&file(lines)[..], "bag.mcap", topics)
        .expect_err(words)
        .to_string();
    assert!(
        message.starts_with(&format!("bag.mcap: {words}")),
        "expected {words}: {message}"
    );
    assert!(message.contains(". "), "no next step: {message}");
}

fn edited(line: Line, change: impl FnOnce(&mut Line)) -> Line {
    let mut line = line;
    change(&mut line);
    line
}

#[test]
fn messages_are_refused_with_place_value_rule_and_next_step() {
    let pose = |numbers: [f64; 7], frame: &str, stamp: i64| {
        edited(object(0, 0.0), |line| {
            line.data = stamped(Order::Little, stamp, frame, &numbers)
        })
    };
    let upright = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let place = "/object/pose, message 2 (log time 0.003000000 s): ";
    for (line, words) in [
        (
            pose([0.0, 0.0, 0.0, 0.0, 0.0, 0.8, 0.8], "world", MS),
            "the orientation's length is 1.13",
        ),
        (
            pose([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], "world", MS),
            "the pose is upside down",
        ),
        (
            pose(upright, "map", MS),
            "header.frame_id is `map`, and `world` in /object/pose; all must be in one frame",
        ),
        (
            pose([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], "world", -5),
            "header.stamp is -0.000000005 s, as in message 1; each message of a topic needs",
        ),
        (
            edited(object(0, 0.0), |line| {
                line.data[8..12].copy_from_slice(&[0, 0xca, 0x9a, 0x3b])
            }),
            "header.stamp.nanosec is 1000000000; it must",
        ),
        (
            edited(object(0, 0.0), |line| line.data.truncate(40)),
            "the message is no geometry_msgs/msg/PoseStamped: ",
        ),
        (
            edited(object(0, 0.0), |line| line.data[1] = 3),
            "the message begins with the bytes 00 03; plain CDR begins",
        ),
    ] {
        refused(
            &[object(-5, 0.0), line, pusher(0, 0.0)],
            &Topics::default(),
            &format!("{place}{words}"),
        );
    }
}

#[test]
fn topics_are_refused_with_place_value_rule_and_next_step() {
    let good = [object(0, 0.0), pusher(0, 0.0)];
    let with = |line: Line| [good.as_slice(), &[line]].concat();
    let plain = Topics::default();
    let other = |kind| edited(object(MS, 0.0), |line| line.kind = kind);
    refused(
        &with(other(BOOL)),
        &plain,
        "/object/pose: its messages are std_msgs/msg/Bool, and geometry_msgs/msg/PoseStamped is needed",
    );
    let json = edited(pusher(MS, 0.0), |line| line.encoding = "json");
    refused(
        &with(json),
        &plain,
        "/pusher/pose: its messages are encoded as `json`; only cdr",
    );
    let tool = edited(wrench(0, 0.0, 0.0), |line| {
        line.data = stamped(Order::Little, 0, "tool", &[0.0; 6])
    });
    refused(
        &with(tool),
        &plain,
        "/pusher/wrench, message 1 (log time 0.003000000 s): header.frame_id is `tool`, and `world` in /object/pose",
    );
    refused(
        &with(touch(2, 0, true)),
        &plain,
        "fixel_1 is not there, and a later number is",
    );
    let words = "the topic `/pusher/pose` (pusher) is not there, the nearest is `/pusher_pose`. Say which topic it is with pusher=TOPIC; the recording has /object/pose, /pusher_pose";
    refused(
        &[object(0, 0.0), pose("/pusher_pose", 0, 0.0)],
        &plain,
        words,
    );
    refused(
        &good,
        &topics(&["wrench=/ft"]),
        "the topic `/ft` (wrench) is not there",
    );
    refused(
        &good,
        &topics(&["fixel_1=/touch"]),
        "the topic `/touch` (fixel_1) is not there",
    );
    let close = 1_700_000_000_000 * MS;
    refused(
        &[
            object(close, 0.0),
            object(close + 1, 0.0),
            pusher(close, 0.0),
        ],
        &plain,
        "two rows are both at 1700000000 s",
    );
}

#[test]
fn files_are_refused_with_place_value_rule_and_next_step() {
    let refused = |bytes: &[u8], words: &str| {
        let message = read_log_mcap(bytes, "bag.mcap", &Topics::default())
            .expect_err(words)
            .to_string();
        assert!(
            message.starts_with(&format!("bag.mcap: {words}")),
            "{message}"
        );
    };
    refused(
        b"time,object_x\n",
        "the file begins with the bytes 74 69 6D 65 2C 6F 62 6A, an MCAP recording with 89 4D",
    );
    refused(b"", "the file begins with the bytes , an MCAP");
    let whole = file(&[object(0, 0.0), pusher(0, 0.0)]);
    refused(&whole[..100], "nothing could be read: ");
    let late: Vec<Line> = (0..50)
        .map(|k| object(30 * MS * k, 0.0))
        .chain([pusher(0, 0.0)])
        .collect();
    let chunks = file_with(&late, None, 1000);
    let words =
        "the topic `/pusher/pose` (pusher) is not there, and the recording is cut off after ";
    refused(&chunks[..chunks.len() / 4], words);
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    for topic in ["/object/pose", "/pusher/pose"] {
        let schema = writer.add_schema(POSE, "ros2msg", b"").unwrap();
        writer
            .add_channel(schema, topic, "cdr", &Default::default())
            .unwrap();
    }
    writer.finish().unwrap();
    refused(
        writer.into_inner().get_ref(),
        "there is no message on `/object/pose` or `/pusher/pose`; at least one is needed",
    );
}

/// A log as a rig without gaps records it.
fn recorded() -> Log {
    let pose = |k: f64| Some(Pose::new(0.001 * k, -0.002 * k, 0.1 * k));
    Log {
        time: (0..40).map(|k| f64::from(k) / 30.0).collect(),
        object: (0..40)
            .map(|k| if k == 7 { None } else { pose(f64::from(k)) })
            .collect(),
        object_covariance: Vec::new(),
        pusher: (0..40).map(|k| pose(f64::from(k) - 3.0)).collect(),
        other_fingers: Vec::new(),
        tactile: vec![
            (0..40).map(|k| Some(k > 20)).collect(),
            (0..40).map(|k| (k > 30).then_some(false)).collect(),
        ],
        force: (0..40)
            .map(|k| (k % 2 == 0).then_some([f64::from(k), 1.0]))
            .collect(),
    }
}

fn written(log: &Log, topics: &Topics) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_log_mcap(&mut bytes, log, topics).unwrap();
    bytes.into_inner()
}

#[test]
fn write_log_mcap_gives_the_same_bytes_and_reads_back() {
    let log = recorded();
    let bytes = written(&log, &Topics::default());
    assert_eq!(bytes, written(&log, &Topics::default()));
    let (back, warnings) = read(&bytes);
    assert_eq!(warnings, []);
    assert_eq!(
        (xs(&back.object), xs(&back.pusher)),
        (xs(&log.object), xs(&log.pusher))
    );
    assert_eq!((&back.tactile, &back.force), (&log.tactile, &log.force));
    let ends = back
        .object
        .iter()
        .zip(&log.object)
        .filter_map(|(back, log)| Some((back.as_ref()?.theta, log.as_ref()?.theta)));
    assert!(
        back.time
            .iter()
            .zip(&log.time)
            .all(|(back, log)| (back - log).abs() <= 0.5e-9)
    );
    assert!(ends.clone().all(|(back, log)| (back - log).abs() < 1e-12));

    let mapped = topics(&["object=/box", "wrench="]);
    let (back, _) = read_log_mcap(&written(&log, &mapped)[..], "bag.mcap", &mapped).unwrap();
    assert!(back.force.is_empty() && back.object == read(&bytes).0.object);
}

#[test]
fn write_log_mcap_refuses_times_that_stamps_do_not_hold() {
    let with = |time: [f64; 2]| {
        let poses = vec![Some(Pose::default()); 2];
        let log = Log {
            time: time.to_vec(),
            object: poses.clone(),
            pusher: poses,
            ..Log::default()
        };
        write_log_mcap(Cursor::new(Vec::new()), &log, &Topics::default())
            .map_err(|error| error.to_string())
    };
    assert_eq!(with([0.0, 2_147_483_647.0]), Ok(()));
    for (time, words) in [
        (
            [-0.1, 0.0],
            "row 0 is at -0.1 s; ROS 2 stamps hold 0 to 2147483647 s. Shift",
        ),
        (
            [0.0, 2_147_483_648.0],
            "row 1 is at 2147483648 s; ROS 2 stamps hold",
        ),
        ([0.0, f64::NAN], "row 1 is at NaN s; ROS 2 stamps hold"),
        (
            [1.0, 1.000_000_000_3],
            "row 1 is at 1.0000000003 s, less than a nanosecond after",
        ),
    ] {
        let message = with(time).unwrap_err();
        assert!(message.starts_with(words), "{message}");
    }
}

/// A small file of each kind of chunk.
fn small(compression: Option<Compression>) -> Vec<u8> {
    let lines = [
        object(0, 0.0),
        pusher(0, 0.0),
        touch(1, 0, true),
        wrench(0, 1.0, 2.0),
        object(30 * MS, 0.1),
        pusher(31 * MS, 0.1),
    ];
    file_with(&lines, compression, 300)
}

/// The chunks' checksums set to 0, "none", so that damage behind them is reached.
fn unchecked(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes
        .get(at + 1..at + 9)
        .map(|length| u64::from_le_bytes(length.try_into().unwrap()))
    {
        if bytes[at] == 6 {
            bytes[at + 33..at + 37].fill(0);
        }
        at += 9 + usize::try_from(length).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn damaged_recordings_are_read_or_refused(
        kind in 0..3_usize,
        checked in any::<bool>(),
        at in any::<prop::sample::Index>(),
        cut in prop_oneof![Just(0_usize), 0..10_usize, 0..2000_usize],
        insert in prop::collection::vec(any::<u8>(), 0..9),
    ) {
        let mut bytes = small([None, Some(Compression::Zstd), Some(Compression::Lz4)][kind]);
        if !checked {
            unchecked(&mut bytes);
        }
        let start = at.index(bytes.len());
        let end = (start + cut).min(bytes.len());
        let damaged = [&bytes[..start], &insert, &bytes[end..]].concat();
        if let Err(error) = read_log_mcap(&damaged[..], "f", &Topics::default()) {
            prop_assert!(error.to_string().starts_with("f: ") && error.to_string().len() > 10);
        }
    }

    #[test]
    fn overwritten_recordings_are_read_or_refused(
        kind in 0..3_usize,
        at in any::<prop::sample::Index>(),
        over in prop_oneof![prop::collection::vec(any::<u8>(), 1..9), Just(vec![0xff; 8]), Just(vec![0; 8])],
    ) {
        let mut bytes = small([None, Some(Compression::Zstd), Some(Compression::Lz4)][kind]);
        unchecked(&mut bytes);
        let start = at.index(bytes.len());
        for (byte, over) in bytes[start..].iter_mut().zip(over) {
            *byte = over;
        }
        let _ = read_log_mcap(&bytes[..], "f", &Topics::default());
    }
}
