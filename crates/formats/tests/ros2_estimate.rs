//! Estimates against other programs: mcap-ros2-support and rosbags read the messages, evo the
//! trajectory.
//!
//! `cargo test -p stickslip-formats --test ros2_estimate -- --ignored`, with these Python packages where
//! `python3` finds them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod ros2_peer;

use std::fs::File;
use std::path::Path;

use ros2_peer::{folder, peer};
use stickslip::{CrossCovariance, Estimate, EstimateRow, Setup, Spread};
use stickslip_dynamics::Pose;
use stickslip_formats::{read_scene, write_estimate_mcap, write_estimate_tum};

/// An estimate of two rows, the first without a pose, in the scene of an embedded experiment; all
/// fixels are touched.
fn one_pose(pose: Pose, std: Pose) -> (Setup, Estimate) {
    let scene = include_str!("../../cli/demo/stop-square50-bar-000/scene.toml");
    let setup = read_scene(scene, "scene.toml").unwrap();
    let fixels = setup.scene.fixels.len();
    let seen = EstimateRow {
        pose: Some(pose),
        contact_fixels: Some(vec![0.75; fixels]),
        spread: Some(Spread {
            pose: std,
            cross: Some(CrossCovariance {
                x_y: 0.015625,
                x_theta: -0.03125,
                y_theta: 0.0625,
            }),
            friction: None,
        }),
        ..EstimateRow::default()
    };
    let estimate = Estimate {
        time: vec![1.0, 2.0],
        rows: vec![EstimateRow::default(), seen],
        fixels,
        has_tripod: true,
    };
    (setup, estimate)
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn others_read_an_estimate() {
    let (pose, std) = (Pose::new(0.5, -0.25, 3.0), Pose::new(0.125, 0.25, 0.5));
    let (setup, estimate) = one_pose(pose, std);
    let path = folder("estimate").join("estimate.mcap");
    // two particles at the row that has a pose
    let cloud = [vec![], vec![pose, std]];
    write_estimate_mcap(File::create(&path).unwrap(), &estimate, &cloud, &setup).unwrap();
    let told = peer(&[Path::new("estimate"), &path]);
    let (z, w) = (libm::sin(1.5), libm::cos(1.5));
    for program in ["ours", "humble"] {
        let mut topics = Vec::new();
        for line in told.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            let [by, topic, time, frame, name, numbers @ ..] = &words[..] else {
                panic!("{line}")
            };
            if *by != program {
                continue;
            }
            assert_eq!((*time, *frame), ("2000000000", "world"), "{line}");
            let numbers: Vec<f64> = numbers.iter().map(|word| word.parse().unwrap()).collect();
            let at = [pose.x, pose.y, z, w];
            match (*topic, *name) {
                ("/stickslip/pose", _) => {
                    let mut covariance = [0.0; 36];
                    (covariance[0], covariance[7], covariance[35]) = (0.015625, 0.0625, 0.25);
                    for (places, value) in
                        [([1, 6], 0.015625), ([5, 30], -0.03125), ([11, 31], 0.0625)]
                    {
                        let [upper, lower] = places;
                        (covariance[upper], covariance[lower]) = (value, value);
                    }
                    assert_eq!(numbers, [&at[..], &covariance].concat());
                }
                ("/tf", child) => assert_eq!((child, &numbers[..]), ("stickslip_object", &at[..])),
                ("/stickslip/particles", _) => {
                    let other = [0.125, 0.25, libm::sin(0.25), libm::cos(0.25)];
                    assert_eq!(numbers, [at, other].concat());
                }
                ("/stickslip/markers", "object") => {
                    let square = [
                        [-1.0, -1.0],
                        [1.0, -1.0],
                        [1.0, 1.0],
                        [-1.0, 1.0],
                        [-1.0, -1.0],
                    ];
                    let side = numbers[11].abs();
                    let points = square.map(|[x, y]| [x * side, y * side, 0.0]);
                    let head = [0.0, 4.0, at[0], at[1], at[2], at[3], 0.12, 5.0];
                    assert_eq!(numbers, [&head[..], points.as_flattened()].concat());
                }
                ("/stickslip/markers", "fixels") => {
                    assert_eq!((numbers[1], numbers[6]), (4.0, 0.84))
                }
                _ => panic!("{line}"),
            }
            topics.push((*topic).to_owned());
        }
        let fixel_parts: usize = setup
            .scene
            .fixels
            .iter()
            .map(|fixel| fixel.shape.parts().len())
            .sum();
        assert_eq!(topics.len(), 4 + fixel_parts, "{program}: {told}");
    }
}

#[test]
#[ignore = "needs Python packages; .ci/run installs them and runs this"]
fn evo_reads_a_trajectory() {
    let pose = Pose::new(0.5, -0.25, 3.0);
    let (_, estimate) = one_pose(pose, Pose::default());
    let path = folder("trajectory").join("estimate.tum");
    write_estimate_tum(File::create(&path).unwrap(), &estimate).unwrap();
    let told = peer(&[Path::new("trajectory"), &path]);
    let numbers: Vec<f64> = told
        .split_whitespace()
        .map(|word| word.parse().unwrap())
        .collect();
    let [time, x, y, z, yaw] = numbers[..] else {
        panic!("{told}")
    };
    assert_eq!([time, x, y, z], [2.0, 0.5, -0.25, 0.0]);
    assert!((yaw - 3.0).abs() < 1e-12, "{yaw}");
}
