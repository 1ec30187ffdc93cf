//! MCAP recordings: each rule of the way from messages to rows on a recording built by hand.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::bag::{
    Line, MS, Order, file, file_with, longer, object, pose, pusher, quaternion, read, stamped,
    topics, touch, wrench, xs,
};
use mcap::Compression;
use stickslip::Log;
use stickslip_formats::read_log_mcap;

/// The log of these messages, which must be read without a warning.
#[track_caller]
fn log(lines: &[Line]) -> Log {
    let (log, warnings) = read(&file(lines));
    assert_eq!(warnings, []);
    log
}

#[test]
fn measurements_have_rows_at_their_own_times() {
    let log = log(&[
        object(0, 1.0),
        object(100 * MS, 2.0),
        pusher(-MS / 2, 10.0),
        pusher(50 * MS, 12.0),
        pusher(100 * MS, 13.0),
        pusher(100 * MS + 1, 14.0),
        touch(1, 70 * MS, true),
        touch(1, 50 * MS, false),
    ]);
    assert_eq!(log.time, [-0.0005, 0.0, 0.05, 0.07, 0.1, 0.100_000_001]);
    let of = |row: usize| {
        (
            xs(&log.object)[row],
            xs(&log.pusher)[row],
            log.tactile[0][row],
        )
    };
    let rows: Vec<_> = (0..6).map(of).collect();
    let expected = [
        (None, Some(10.0), None),
        (Some(1.0), None, None),
        (None, Some(12.0), Some(false)),
        (None, None, Some(true)),
        (Some(2.0), Some(13.0), None),
        (None, Some(14.0), None),
    ];
    assert_eq!(rows, expected);
    assert!(log.force.is_empty());
}

#[test]
fn stamps_that_are_equal_in_seconds_are_one_row_with_the_covariance() {
    // 240 ns apart are one number of seconds since 1970
    let now = 1_700_000_000_000 * MS;
    let object = longer(
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        now + 40,
        1.0,
        None,
        36,
    );
    let log = log(&[object, pusher(now, 2.0)]);
    assert_eq!(
        (xs(&log.object), xs(&log.pusher)),
        (vec![Some(1.0)], vec![Some(2.0)])
    );
    assert!(log.object_covariance[0].is_some());
}

#[test]
fn reading_shortly_after_a_step_is_in_its_row() {
    let us = MS / 1000;
    // rows at 0, 30 and 60 ms make steps; that 0.3 ms later makes none
    let mut lines = vec![object(30 * MS, 0.0), object(60 * MS, 0.0)];
    lines.extend([pusher(0, 0.0), pusher(30 * MS + 300 * us, 0.0)]);
    lines.extend([
        touch(1, 30 * MS + 100 * us, false),
        touch(1, 30 * MS + 400 * us, true),
        touch(1, 30 * MS + 900 * us, false),
        touch(1, 31 * MS + 100 * us, false),
        touch(1, 59 * MS + 900 * us, true),
    ]);
    let log = log(&lines);
    let times = [0.0, 0.03, 0.0303, 0.0311, 0.0599, 0.06];
    assert_eq!(log.time, times);
    let cells = [None, Some(true), None, Some(false), Some(true), None];
    assert_eq!(log.tactile, [cells]);
}

#[test]
fn readings_far_from_all_poses_are_left_out_and_counted() {
    let mut lines = vec![object(2000 * MS, 0.0), pusher(2100 * MS, 0.0)];
    lines.extend([999, 1000, 3100, 3101].map(|ms| touch(1, ms * MS, true)));
    let (log, warnings) = read(&file(&lines));
    assert_eq!(log.time, [1.0, 2.0, 2.1, 3.1]);
    let left_out = warnings[0].left_out().unwrap();
    assert_eq!(
        (left_out.place.as_str(), left_out.count, left_out.of),
        ("/fixel_1/contact", 2, 4)
    );
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
    let (log, warnings) = read(&file(&lines));
    assert!(warnings.is_empty(), "{warnings:?}");
    for (k, pose) in log.object.iter().enumerate() {
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
    let (log, warnings) = read_log_mcap(&file(&lines)[..], "bag.mcap", &swapped).unwrap();
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
    let words = "bag.mcap: /fixel_1/contact: 1 of 1 messages are left out: the topic is at 1700000000.000000000 to 1700000000.000000000 s, the poses at 0.000000000";
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
