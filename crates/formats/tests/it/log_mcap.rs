//! MCAP recordings: each rule of the way from messages to rows on a recording built by hand.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::bag::{
    Line, MS, Order, file, file_with, object, pose, pusher, quaternion, read, stamped, topics,
    touch, wrench, xs,
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
fn rows_stand_at_object_stamps_with_the_nearest_pusher_pose_within_a_millisecond() {
    let log = log(&[
        object(0, 1.0),
        object(100 * MS, 2.0),
        pusher(-MS / 2, 10.0),
        pusher(MS, 11.0),
        pusher(50 * MS, 12.0),
        pusher(101 * MS, 13.0),
        pusher(101 * MS + 1, 14.0),
    ]);
    assert_eq!(log.time, [0.0, 0.1]);
    assert_eq!(xs(&log.object), [Some(1.0), Some(2.0)]);
    // half a millisecond is nearer than a whole one
    assert_eq!(xs(&log.pusher), [Some(10.0), Some(13.0)]);
    assert!(log.tactile.is_empty() && log.force.is_empty());
}

#[test]
fn fast_pusher_makes_rows_only_where_the_camera_is_blocked_at_about_its_rate() {
    // 25 Hz, occluded from 200 to 400 ms and from 600 ms on; the pusher at 500 Hz from 200 ms
    // before
    let seen = |k: &i64| *k <= 5 || (10..=15).contains(k);
    let lines: Vec<Line> = (0..25)
        .filter(seen)
        .map(|k| object(40 * MS * k, 0.0))
        .chain((-100..500).map(|k| pusher(2 * MS * k, k as f64)))
        .collect();
    let log = log(&lines);
    let dark = |from: f64, to: f64| {
        let rows = log.time.iter().zip(&log.object);
        let inside = rows.filter(|(time, _)| **time > from && **time < to);
        let times: Vec<f64> = inside
            .map(|(time, pose)| pose.map_or(*time, |_| f64::NAN))
            .collect();
        assert!(times.iter().all(|time| time.is_finite()), "{times:?}");
        times.len()
    };
    assert_eq!((dark(0.2, 0.4), dark(0.6, 1.0), dark(-1.0, 0.0)), (4, 9, 5));
    assert_eq!(log.object.iter().flatten().count(), 12);
    let steps: Vec<f64> = log.time.array_windows().map(|[a, b]| b - a).collect();
    assert!(
        steps.iter().all(|h| (0.035..=0.045).contains(h)),
        "{steps:?}"
    );
    assert!(log.pusher.iter().all(Option::is_some));
}

#[test]
fn two_poses_of_the_object_leave_rows_of_the_pusher_between_them() {
    let lines: Vec<Line> = [object(0, 0.0), object(3000 * MS, 1.0)]
        .into_iter()
        .chain((0..100).map(|k| pusher(30 * MS * k, 0.0)))
        .chain((0..3000).map(|k| pusher(4000 * MS + MS * k, 0.0)))
        .collect();
    let slow = log(&lines[..102]);
    assert_eq!((slow.len(), slow.object.iter().flatten().count()), (101, 2));
    let fast = log(&lines);
    assert_eq!(fast.time.iter().filter(|time| **time >= 4.0).count(), 60);
}

#[test]
fn pusher_between_two_frames_is_interpolated_without_a_row_of_its_own() {
    let lines: Vec<Line> = (0..20)
        .flat_map(|k| {
            [
                object(40 * MS * k, 0.0),
                pusher(40 * MS * k + 13 * MS, k as f64),
            ]
        })
        .collect();
    let log = log(&lines);
    assert_eq!((log.len(), log.object.iter().flatten().count()), (20, 20));
    let expected = 3.0 + 27.0 / 40.0;
    assert!((log.pusher[4].unwrap().x - expected).abs() < 1e-12);
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
    assert_eq!(near.time, [-0.01, 0.05, 0.3]);
    assert_eq!(xs(&near.pusher), [None, Some(1.25), None]);
    // the short way, over half a turn
    assert!((near.pusher[1].unwrap().theta - (3.0 + (2.0 * PI - 6.0) / 4.0)).abs() < 1e-12);
    assert_eq!(xs(&log(&lines(200 * MS + 1)).pusher)[1], None);
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
