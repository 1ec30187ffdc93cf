//! MCAP recordings: each rule of the way from messages to rows on a recording built by hand, every
//! kind of bad input at its place, damaged files, and what is written.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod bag;

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::io::Cursor;

use bag::{
    BOOL, Line, MS, Order, POSE, file, file_with, object, pose, pusher, quaternion, stamped, touch,
    wrench,
};
use mcap::Compression;
use proptest::prelude::*;
use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{LogWarning, Topics, read_log_mcap, write_log_mcap};

fn topics(mappings: &[&str]) -> Topics {
    Topics::new(mappings.iter().map(|text| text.parse().unwrap())).unwrap()
}

#[track_caller]
fn read(bytes: &[u8]) -> (Log, Vec<LogWarning>) {
    read_log_mcap(bytes, "bag.mcap", &Topics::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The log of these messages, which must be read without a warning.
#[track_caller]
fn log(lines: &[Line]) -> Log {
    let (log, warnings) = read(&file(lines));
    assert_eq!(warnings, []);
    log
}

fn xs(poses: &[Option<Pose>]) -> Vec<Option<f64>> {
    poses.iter().map(|pose| pose.map(|pose| pose.x)).collect()
}

#[test]
fn rows_stand_at_object_stamps_and_at_pusher_stamps_more_than_a_millisecond_away() {
    let log = log(&[
        object(0, 1.0),
        object(100 * MS, 2.0),
        pusher(-MS / 2, 10.0),
        pusher(MS, 11.0),
        pusher(50 * MS, 12.0),
        pusher(101 * MS, 13.0),
        pusher(101 * MS + 1, 14.0),
    ]);
    assert_eq!(log.time, [0.0, 0.05, 0.1, 0.101_000_001]);
    assert_eq!(xs(&log.object), [Some(1.0), None, Some(2.0), None]);
    // half a millisecond is nearer than a whole one
    assert_eq!(
        xs(&log.pusher),
        [Some(10.0), Some(12.0), Some(13.0), Some(14.0)]
    );
    assert!(log.tactile.is_empty() && log.force.is_empty());
}

#[test]
fn pusher_is_interpolated_over_at_most_a_fifth_of_a_second() {
    let turned = |angle: f64| [0.0, 0.0, libm::sin(angle / 2.0), libm::cos(angle / 2.0)];
    let lines = |last: i64| {
        vec![
            object(-10 * MS, 0.0),
            object(50 * MS, 0.0),
            object(300 * MS, 0.0),
            quaternion("/pusher/pose", 0, 1.0, turned(3.0)),
            quaternion("/pusher/pose", last, 2.0, turned(-3.0)),
        ]
    };
    let near = log(&lines(200 * MS));
    assert_eq!(near.time, [-0.01, 0.0, 0.05, 0.2, 0.3]);
    assert_eq!(
        xs(&near.pusher),
        [None, Some(1.0), Some(1.25), Some(2.0), None]
    );
    // the short way, over half a turn
    assert!((near.pusher[2].unwrap().theta - (3.0 + (2.0 * PI - 6.0) / 4.0)).abs() < 1e-12);
    assert_eq!(xs(&log(&lines(200 * MS + 1)).pusher)[2], None);
}

#[test]
fn tactile_cell_is_any_touch_in_the_interval_else_the_last_reading_within_half_a_second() {
    let rows = [0, 1000, 2000, 2500, 2501].map(|ms| object(ms * MS, 0.0));
    let readings = [
        (-0, true),
        (900, true),
        (1000, false),
        (1001, false),
        (2000, false),
        (2000, true),
    ];
    let touches = readings.map(|(ms, on)| touch(1, ms * MS, on));
    let lines = [rows.as_slice(), &[pusher(0, 0.0)], &touches].concat();
    let cells = [Some(true), Some(true), Some(true), Some(true), None];
    assert_eq!(log(&lines).tactile, [cells]);

    // an interval with false readings only, and a reading before the first row
    let lines = [
        object(400 * MS, 0.0),
        object(600 * MS, 0.0),
        pusher(400 * MS, 0.0),
        touch(1, 0, true),
        touch(1, 500 * MS, false),
    ];
    assert_eq!(log(&lines).tactile, [[Some(true), Some(false)]]);
}

#[test]
fn force_cell_is_the_mean_over_the_interval() {
    let forces = [
        wrench(0, 1.0, 0.0),
        wrench(MS, 2.0, 4.0),
        wrench(100 * MS, 4.0, -2.0),
        wrench(301 * MS, 5.0, 5.0),
    ];
    let rows = [0, 100, 200, 300].map(|ms| object(ms * MS, 0.0));
    let log = log(&[rows.as_slice(), &[pusher(0, 0.0)], &forces].concat());
    assert_eq!(log.force, [Some([1.0, 0.0]), Some([3.0, 1.0]), None, None]);
}

#[test]
fn first_interval_is_as_long_as_the_second_and_that_of_a_single_row_is_its_time() {
    let before = [
        wrench(899 * MS, 9.0, 0.0),
        wrench(900 * MS, 8.0, 0.0),
        wrench(900 * MS + 1, 1.0, 0.0),
        wrench(1000 * MS, 2.0, 0.0),
    ];
    let two = [
        object(1000 * MS, 0.0),
        object(1100 * MS, 0.0),
        pusher(1000 * MS, 0.0),
    ];
    assert_eq!(
        log(&[two.as_slice(), &before].concat()).force,
        [Some([1.5, 0.0]), None]
    );
    let one = [object(1000 * MS, 0.0), pusher(1000 * MS, 0.0)];
    assert_eq!(
        log(&[one.as_slice(), &before].concat()).force,
        [Some([2.0, 0.0])]
    );
}

#[test]
fn angle_is_that_about_the_vertical_and_unwrapped() {
    let s = FRAC_1_SQRT_2;
    // 0, 90, 180, 270, 360 degrees; the second quaternion with the other sign, which is the same
    // rotation
    let quarters = [
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, -s, -s],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, s, -s],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let mut lines: Vec<Line> = (0..)
        .zip(quarters)
        .map(|(k, q)| quaternion("/object/pose", 100 * MS * k, 0.0, q))
        .collect();
    lines.push(pusher(0, 0.0));
    // in the file in another order than in time
    lines.reverse();
    for (k, pose) in log(&lines).object.iter().enumerate() {
        assert!(
            (pose.unwrap().theta - k as f64 * PI / 2.0).abs() < 1e-12,
            "{k}: {pose:?}"
        );
    }
}

#[test]
fn all_ways_to_store_a_message_give_the_same_log() {
    let lines: Vec<Line> = (0..50)
        .flat_map(|k| {
            [
                object(30 * MS * k, k as f64),
                pusher(30 * MS * k, 0.5),
                touch(1, 30 * MS * k, k > 20),
            ]
        })
        .collect();
    let plain = read(&file(&lines));
    assert_eq!((plain.0.len(), plain.1.len()), (50, 0));
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        assert_eq!(read(&file_with(&lines, compression, 2000)), plain);
    }
    let mut big = lines.clone();
    for (k, line) in (0..).zip(big.chunks_mut(3)) {
        line[0].data = stamped(
            Order::Big,
            30 * MS * k,
            "world",
            &[k as f64, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        );
    }
    assert_eq!(read(&file(&big)), plain);
}

#[test]
fn topics_are_mapped_and_others_left() {
    let lines = [
        pose("/vicon/box/pose", 0, 1.0),
        pusher(0, 2.0),
        touch(1, 0, true),
        touch(2, 0, false),
        Line {
            topic: "/tf".to_owned(),
            kind: "tf2_msgs/msg/TFMessage",
            encoding: "json",
            log_time: 0,
            data: vec![1],
        },
        wrench(0, 1.0, 1.0),
    ];
    let swapped = topics(&[
        "object=/vicon/box/pose",
        "fixel_1=/fixel_2/contact",
        "fixel_2=/fixel_1/contact",
        "wrench=",
    ]);
    let (log, warnings) = read_log_mcap(&file(&lines), "bag.mcap", &swapped).unwrap();
    assert_eq!(
        (xs(&log.object), log.tactile, warnings.len()),
        (
            vec![Some(1.0)],
            vec![vec![Some(false)], vec![Some(true)]],
            0
        )
    );
    assert!(log.force.is_empty());
}

#[test]
fn large_stamps_keep_their_place() {
    let start = 1_700_000_000_000 * MS;
    let log = log(&[
        object(start, 1.0),
        object(start + 33 * MS, 2.0),
        pusher(start, 0.0),
    ]);
    assert_eq!(log.time, [1_700_000_000.0, 1_700_000_000.033]);
}

#[test]
fn odd_recordings_are_read_with_a_warning() {
    // 10 and 4.9 degrees about x
    let tilted = |stamp: i64, angle: f64| {
        quaternion(
            "/object/pose",
            stamp,
            0.0,
            [libm::sin(angle / 2.0), 0.0, 0.0, libm::cos(angle / 2.0)],
        )
    };
    let lines = [
        tilted(0, 4.9 / 180.0 * PI),
        tilted(100 * MS, PI / 18.0),
        pusher(0, 0.0),
    ];
    let (log, warnings) = read(&file(&lines));
    assert_eq!(
        (log.len(), warnings.len(), warnings[0].is_loss()),
        (2, 1, false)
    );
    let words = warnings[0].to_string();
    assert!(words.starts_with("bag.mcap: /object/pose: 1 of 2 poses are tilted by more than 5 deg, the most by 10.0 deg"), "{words}");

    let other_clock = [
        object(0, 0.0),
        pusher(0, 0.0),
        touch(1, 1_700_000_000_000 * MS, true),
    ];
    let (log, warnings) = read(&file(&other_clock));
    assert_eq!(log.tactile, [[None]]);
    let words = "bag.mcap: /fixel_1/contact: all messages are at 1700000000.000000000 to 1700000000.000000000 s and the poses at 0.000000000";
    assert!(
        warnings[0].to_string().starts_with(words),
        "{}",
        warnings[0]
    );
}

#[test]
fn recording_that_was_cut_off_is_read_up_to_there() {
    let lines: Vec<Line> = (0..100)
        .flat_map(|k| [object(30 * MS * k, k as f64), pusher(30 * MS * k, 0.5)])
        .collect();
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let whole = file_with(&lines, compression, 1000);
        let (log, warnings) = read(&whole[..whole.len() - 8]);
        assert_eq!(
            (log.len(), warnings.len()),
            (100, 1),
            "only the end mark is missing"
        );
        let (log, warnings) = read(&whole[..whole.len() / 3]);
        assert!(
            log.len() > 5 && log.len() < 70 && warnings[0].is_loss(),
            "{}",
            log.len()
        );
        assert!(
            log.object
                .iter()
                .enumerate()
                .all(|(k, pose)| pose.is_none_or(|pose| pose.x == k as f64))
        );
        let words = warnings[0].to_string();
        let size = whole.len() / 3;
        assert!(
            words.starts_with("bag.mcap: the recording is cut off or damaged after ")
                && words.contains(&format!(" of {size} bytes"))
        );
    }
}

#[test]
fn chunk_with_a_wrong_checksum_ends_the_recording() {
    let lines: Vec<Line> = (0..100)
        .flat_map(|k| [object(30 * MS * k, k as f64), pusher(30 * MS * k, 0.5)])
        .collect();
    let mut bytes = file_with(&lines, None, 1000);
    let middle = bytes.len() / 3;
    let needle = 0.5_f64.to_le_bytes();
    let at = middle
        + bytes[middle..]
            .windows(8)
            .position(|window| window == needle)
            .unwrap();
    bytes[at] ^= 1;
    let (log, warnings) = read(&bytes);
    assert!(
        log.len() < 60 && log.pusher.iter().flatten().all(|pose| pose.x == 0.5),
        "{}",
        log.len()
    );
    assert!(
        warnings[0]
            .to_string()
            .contains("a chunk's checksum is wrong"),
        "{}",
        warnings[0]
    );
}

#[test]
fn attachments_are_not_looked_at() {
    let mut bytes = file(&[object(0, 1.0), pusher(0, 2.0)]);
    // shorter than an attachment's fields and checksum
    let record = [vec![9], 34_u64.to_le_bytes().to_vec(), vec![0; 34]].concat();
    bytes.splice(8..8, record);
    let (log, warnings) = read(&bytes);
    assert_eq!((xs(&log.object), warnings), (vec![Some(1.0)], vec![]));
}

#[track_caller]
fn refused(lines: &[Line], topics: &Topics, words: &str) {
    let message = read_log_mcap(&file(lines), "bag.mcap", topics)
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
            pose([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], "world", MS),
            "position.x is NaN; numbers must be finite",
        ),
        (
            pose([0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0, 1.0], "world", MS),
            "position.z is inf",
        ),
        (
            pose([0.0; 7], "world", MS),
            "the orientation's length is 0; it must be 1 within 0.01",
        ),
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
            pose(upright, "world", -5),
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
        "sensors are numbered fixel_1, fixel_2, ... without gaps, and fixel_1 is not there",
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
        pusher: (0..40).map(|k| pose(f64::from(k) - 3.0)).collect(),
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
    let (back, _) = read_log_mcap(&written(&log, &mapped), "bag.mcap", &mapped).unwrap();
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

/// The chunks' checksums set to 0, "none", so that what is damaged behind them is looked at.
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
        if let Err(error) = read_log_mcap(&damaged, "f", &Topics::default()) {
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
        let _ = read_log_mcap(&bytes, "f", &Topics::default());
    }
}
