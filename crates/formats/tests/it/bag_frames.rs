//! Bags as ROS 2 leaves them: poses in other messages than PoseStamped, between frames of
//! transforms, from several tags; forces as touches; files, chunks and messages packed and split.

use crate::bag;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::bag::{
    Line, MS, Transform, file, file_with, object, pusher, topics, touch, transforms, wrench,
};
use mcap::Compression;
use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{BagOptions, LogWarning, McapError, Mounts, read_bag};

fn options(mappings: &[&str]) -> BagOptions {
    BagOptions {
        topics: topics(mappings),
        ..BagOptions::default()
    }
}

fn read(lines: &[Line], options: &BagOptions) -> Result<(Log, Vec<LogWarning>), McapError> {
    let bytes = file(lines);
    read_bag([("bag.mcap".to_owned(), &bytes[..])], options)
}

#[track_caller]
fn refused(lines: &[Line], options: &BagOptions, words: &str) {
    let message = read(lines, options).expect_err(words).to_string();
    assert!(
        message.starts_with(&format!("bag.mcap: {words}")),
        "{message}"
    );
    assert!(message.contains(". "), "no next step: {message}");
}

type Matrix = [[f64; 4]; 4];

/// A rigid motion as a matrix, of a translation and a rotation about one axis: the oracle shares no
/// code with quaternions.
fn motion(at: [f64; 3], axis: usize, angle: f64) -> Matrix {
    let (s, c) = libm::sincos(angle);
    let mut m = [[0.0; 4]; 4];
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    m[axis][axis] = 1.0;
    (m[i][i], m[i][j], m[j][i], m[j][j], m[3][3]) = (c, -s, s, c, 1.0);
    for (row, at) in m.iter_mut().zip(at) {
        row[3] = at;
    }
    m
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..4).map(|k| a[i][k] * b[k][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The inverse of a rigid motion.
fn inverse(m: Matrix) -> Matrix {
    let mut out = [[0.0; 4]; 4];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = m[j][i];
        }
        out[i][3] = -(0..3).map(|k| m[k][i] * m[k][3]).sum::<f64>();
    }
    out[3][3] = 1.0;
    out
}

/// Translation and quaternion of a motion, by the largest of the four squares.
fn numbers(m: Matrix) -> [f64; 7] {
    let trace = m[0][0] + m[1][1] + m[2][2];
    let squares = [m[0][0], m[1][1], m[2][2], trace].map(|d| 1.0 + 2.0 * d - trace);
    let squares = [squares[0], squares[1], squares[2], 1.0 + trace];
    let largest = (0..4)
        .max_by(|a, b| squares[*a].total_cmp(&squares[*b]))
        .unwrap();
    let half = squares[largest].sqrt() / 2.0;
    let mut q = [0.0; 4];
    q[largest] = half;
    if largest == 3 {
        q[0] = (m[2][1] - m[1][2]) / (4.0 * half);
        q[1] = (m[0][2] - m[2][0]) / (4.0 * half);
        q[2] = (m[1][0] - m[0][1]) / (4.0 * half);
    } else {
        let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
        q[j] = (m[i][j] + m[j][i]) / (4.0 * half);
        q[k] = (m[i][k] + m[k][i]) / (4.0 * half);
        q[3] = (m[k][j] - m[j][k]) / (4.0 * half);
    }
    [m[0][3], m[1][3], m[2][3], q[0], q[1], q[2], q[3]]
}

/// A camera 0.8 m above the table that faces down, turned by 0.4 about its axis.
fn camera() -> Matrix {
    product(motion([0.1, -0.2, 0.8], 0, PI), motion([0.0; 3], 2, 0.4))
}

/// A tag on the table, its z-axis up, or down where `down` says so.
fn tag(pose: Pose, down: bool) -> Matrix {
    let upright = motion([pose.x, pose.y, 0.01], 2, pose.theta);
    let over = if down { PI } else { 0.0 };
    product(upright, motion([0.0; 3], 0, over))
}

fn body(k: i64) -> Pose {
    let k = k as f64;
    Pose::new(0.02 + 0.001 * k, -0.03 + 0.0005 * k, 2.9 + 0.02 * k)
}

/// Transforms from the camera to a tag and back to the table: 30 frames, the table's frame seen as
/// a child of the camera as well.
fn seen_by_camera(mount: Pose, down: bool) -> Vec<Line> {
    (0..30)
        .map(|k| {
            let object = body(k);
            let [x, y] = object.transform([mount.x, mount.y]);
            let at = tag(Pose::new(x, y, object.theta + mount.theta), down);
            let tag = numbers(product(inverse(camera()), at));
            let stamp = 33 * MS * k;
            transforms("/tf", &[(stamp, "camera", "tag36h11:7", tag)])
        })
        .collect()
}

#[track_caller]
fn assert_is_body(log: &Log, of: impl Fn(i64) -> Pose) {
    assert!(log.len() >= 20);
    for (time, pose) in log.time.iter().zip(&log.object) {
        let (pose, expected) = (pose.unwrap(), of((time / 0.033).round() as i64));
        let apart = [
            pose.x - expected.x,
            pose.y - expected.y,
            pose.theta - expected.theta,
        ];
        assert!(
            apart.iter().all(|d| d.abs() < 1e-12),
            "{time}: {pose:?} {expected:?}"
        );
    }
}

#[test]
fn body_is_read_through_camera_tag_and_mount_whichever_way_the_tag_faces() {
    let mount = Pose::new(0.012, -0.004, FRAC_PI_2);
    for down in [false, true] {
        let table = numbers(inverse(camera()));
        let mut lines = seen_by_camera(mount, down);
        lines.push(transforms("/tf_static", &[(0, "camera", "table", table)]));
        lines.push(pusher_in("table", 0));
        let mut options = options(&["object=/tf:table.tag36h11:7"]);
        options.mounts.object.insert("tag36h11:7".to_owned(), mount);
        let (log, warnings) = read(&lines, &options).unwrap();
        assert_eq!(warnings, []);
        assert_is_body(&log, body);
    }
}

fn pusher_in(frame: &str, stamp: i64) -> Line {
    let mut line = pusher(stamp, 1.0);
    line.data = bag::stamped(
        bag::Order::Little,
        stamp,
        frame,
        &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    );
    line
}

#[test]
fn links_that_move_too_are_interpolated_at_the_stamps_of_the_tag() {
    // the camera moves evenly along x, published 20 ms apart and out of step with the tag
    let arm = |time: i64| motion([1e-9 * time as f64, 0.0, 0.0], 2, 0.3);
    let mut lines: Vec<Line> = (-2..60)
        .map(|k| (20 * k + 7) * MS)
        .map(|stamp| transforms("/tf", &[(stamp, "table", "arm", numbers(arm(stamp)))]))
        .collect();
    for k in 0..30 {
        let stamp = 33 * MS * k;
        let tag = numbers(product(inverse(arm(stamp)), tag(body(k), false)));
        lines.push(transforms("/tf", &[(stamp, "arm", "tag_7", tag)]));
    }
    lines.push(pusher_in("table", 0));
    // the tag's all after the arm's
    let (log, warnings) = read(&lines, &options(&["object=/tf:table.tag_7"])).unwrap();
    assert_eq!(warnings, []);
    assert_is_body(&log, body);

    // and are not known where they were silent for longer than 0.2 s
    let silent: Vec<Line> = lines
        .iter()
        .filter(|line| {
            let arm = line.data.windows(3).any(|w| w == b"arm")
                && !line.data.windows(5).any(|w| w == b"tag_7");
            !(arm && (300 * MS..600 * MS).contains(&line.log_time))
        })
        .cloned()
        .collect();
    let (log, warnings) = read(&silent, &options(&["object=/tf:table.tag_7"])).unwrap();
    assert_is_body(&log, body);
    let words = warnings[0].to_string();
    assert!(
        words.starts_with("bag.mcap: /tf:table.tag_7: ")
            && words.contains(" of 30 poses are left out: the other transforms"),
        "{words}"
    );
}

#[test]
fn several_tags_of_a_body_are_one_pose_and_each_counts_where_it_is_seen_alone() {
    let mounts = [Pose::new(0.02, 0.0, 0.0), Pose::new(-0.02, 0.01, 1.0)];
    let mut lines = vec![pusher_in("table", 0)];
    for k in 0..30 {
        for (name, mount) in ["a", "b"].iter().zip(mounts) {
            // the first one is hidden for a while, then the other
            if (*name == "a" && (5..12).contains(&k)) || (*name == "b" && (15..22).contains(&k)) {
                continue;
            }
            let object = body(k);
            let [x, y] = object.transform([mount.x, mount.y]);
            let at = numbers(tag(Pose::new(x, y, object.theta + mount.theta), false));
            lines.push(transforms("/tf", &[(33 * MS * k, "table", name, at)]));
        }
    }
    let mut both = options(&["object=/tf:table.a", "object=/tf:table.b"]);
    refused(
        &lines,
        &both,
        "/tf: `a` is not among the tags of the object in the scene, which has none. Say there",
    );
    both.mounts = Mounts {
        object: ["a", "b"]
            .map(str::to_owned)
            .into_iter()
            .zip(mounts)
            .collect(),
        ..Mounts::default()
    };
    let (log, warnings) = read(&lines, &both).unwrap();
    assert_eq!((log.len(), warnings), (30, vec![]));
    assert_is_body(&log, body);
}

#[test]
fn frames_are_refused_with_place_value_rule_and_next_step() {
    let still = numbers(motion([0.0; 3], 2, 0.0));
    let tf = |transforms_: &[Transform<'_>]| {
        vec![
            pusher_in("table", 0),
            transforms("/tf", transforms_),
            transforms("/tf_static", &[(0, "map", "table", still)]),
        ]
    };
    let tag = options(&["object=/tf:table.tag_7"]);
    refused(
        &tf(&[(0, "camera", "tag_7", still)]),
        &tag,
        "/tf: no transforms lead from `tag_7` to `table`. Name two frames that are joined; the recording has camera, map, table, tag_7",
    );
    refused(
        &tf(&[(0, "table", "tag_7", still), (0, "camera", "tag_7", still)]),
        &tag,
        "/tf: the frame `tag_7` is below `camera` and `table`; a frame has one parent",
    );
    refused(
        &tf(&[(0, "a", "b", still), (0, "b", "a", still)]),
        &options(&["object=/tf:table.a"]),
        "/tf: the frame `b` is below `a` and `a`",
    );
    refused(
        &tf(&[(0, "table", "tag_7", still)]),
        &options(&["object=/tf:map.table"]),
        "/tf: from map.table, all transforms are static",
    );
    let mut other = still;
    other[0] = 0.5;
    refused(
        &tf(&[(5, "table", "tag_7", still), (5, "table", "tag_7", other)]),
        &tag,
        "/tf, message 1 (log time 0.003000005 s): header.stamp is 0.000000005 s, as in message 1",
    );
    let mut long = still;
    long[6] = 1.1;
    refused(
        &tf(&[(5, "table", "tag_7", long)]),
        &tag,
        "/tf, message 1 (log time 0.003000005 s): the orientation's length is 1.1",
    );
    refused(
        &tf(&[(0, "table", "tag_7", still)]),
        &options(&["object=/tf"]),
        "/tf: it carries transforms between frames. Say which two",
    );
    refused(
        &[
            pusher_in("world", 0),
            transforms("/tf", &[(0, "table", "tag_7", still)]),
        ],
        &tag,
        "/pusher/pose, message 1 (log time 0.003000000 s): header.frame_id is `world`, and `table` in /tf",
    );
    // one transform published twice is one
    let twice = tf(&[(0, "table", "tag_7", still), (0, "table", "tag_7", still)]);
    assert_eq!(read(&twice, &tag).unwrap().0.len(), 1);
}

#[test]
fn detections_of_tags_are_refused_with_where_their_poses_are() {
    for kind in [
        "apriltag_msgs/msg/AprilTagDetectionArray",
        "isaac_ros_apriltag_interfaces/msg/AprilTagDetectionArray",
    ] {
        let detections = Line {
            topic: "/detections".to_owned(),
            kind,
            ..object(0, 0.0)
        };
        let options = options(&["object=/detections"]);
        let lines = [detections, pusher(0, 0.0)];
        refused(
            &lines,
            &options,
            "/detections: it carries where tags are in the image, and no poses",
        );
    }
}

#[test]
fn forces_are_touches_from_the_threshold_on() {
    let mut lines: Vec<Line> = (0..4).map(|k| object(100 * MS * k, 0.0)).collect();
    lines.push(pusher(0, 0.0));
    // the third component of each is 9 N
    for (k, x) in [(0, 0.0), (1, 11.9), (2, 12.0), (3, -12.0)] {
        let mut line = wrench(100 * MS * k, x, 0.0);
        line.topic = "/tip/wrench".to_owned();
        line.data = bag::stamped(
            bag::Order::Little,
            100 * MS * k,
            "tip",
            &[x, 0.0, 9.0, 0.0, 0.0, 0.0],
        );
        lines.push(line);
    }
    let mut options = options(&["fixel_1=/tip/wrench"]);
    options.touch_force = 15.0;
    let (log, _) = read(&lines, &options).unwrap();
    assert_eq!(log.tactile, [[false, false, true, true].map(Some)]);
    lines.push(touch(2, 0, true));
    assert_eq!(read(&lines, &options).unwrap().0.tactile.len(), 2);
}

#[test]
fn split_and_packed_bags_give_the_same_log() {
    let lines: Vec<Line> = (0..60)
        .flat_map(|k| {
            [
                object(30 * MS * k, k as f64),
                pusher(30 * MS * k, 0.5),
                touch(1, 30 * MS * k, k > 20),
            ]
        })
        .collect();
    let plain = read(&lines, &BagOptions::default()).unwrap();
    let packed = |bytes: &[u8]| zstd::encode_all(bytes, 3).unwrap();
    let parts: Vec<Vec<u8>> = lines
        .chunks(50)
        .map(|part| file_with(part, Some(Compression::Zstd), 1000))
        .collect();
    let split = |parts: &[Vec<u8>]| {
        let named = parts.iter().enumerate();
        let files: Vec<(String, &[u8])> = named
            .map(|(k, part)| (format!("bag_{k}.mcap"), &part[..]))
            .collect();
        // in another order than recorded
        read_bag(files.into_iter().rev(), &BagOptions::default()).unwrap()
    };
    assert_eq!(split(&parts), plain);
    let whole: Vec<Vec<u8>> = parts.iter().map(|part| packed(part)).collect();
    assert_eq!(split(&whole), plain);
    let messages: Vec<Line> = lines
        .iter()
        .map(|line| Line {
            data: packed(&line.data),
            ..line.clone()
        })
        .collect();
    assert_eq!(read(&messages, &BagOptions::default()).unwrap(), plain);

    // of a file that is cut off, the others are whole
    let mut cut = parts.clone();
    let half = cut[1].len() / 2;
    cut[1].truncate(half);
    let (log, warnings) = split(&cut);
    assert!(log.len() > 40 && log.len() < 60, "{}", log.len());
    assert!(
        warnings[0].is_loss()
            && warnings[0]
                .to_string()
                .starts_with("bag_1.mcap: the recording is cut off")
    );
    cut[1] = packed(&parts[1]);
    let half = cut[1].len() / 2;
    cut[1].truncate(half);
    let (log, warnings) = split(&cut);
    assert!(
        log.len() > 40 && log.len() < 60 && warnings[0].is_loss(),
        "{} {warnings:?}",
        log.len()
    );
}

#[test]
fn message_that_unpacks_to_far_more_than_a_pose_is_refused() {
    let mut line = object(0, 0.0);
    line.data = zstd::encode_all(&vec![0; 1 << 24][..], 3).unwrap();
    refused(
        &[line, pusher(0, 0.0)],
        &BagOptions::default(),
        "a message on `/object/pose` has 65537 bytes, more than the 65536",
    );
}
