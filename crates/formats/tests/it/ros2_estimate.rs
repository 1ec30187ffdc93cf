//! Estimates against other programs: mcap-ros2-support and rosbags read the messages, evo the
//! trajectory.
//!
//! `cargo test -p stickslip-formats --test it -- --ignored ros2_estimate::`, with these Python
//! packages where `python3` finds them.

use std::fs::File;
use std::path::Path;

use crate::ros2_peer::{folder, peer};
use stickslip::{
    BeliefMode, ContactSlip, CrossCovariance, Estimate, EstimateRow, Log, Setup, Spread,
};
use stickslip_dynamics::{Friction, Part, Pose};
use stickslip_formats::{estimate_columns, read_scene, write_estimate_mcap, write_estimate_tum};

/// An estimate of two rows, the first without a pose, in the scene of an embedded experiment; all
/// fixels are touched.
fn one_pose(pose: Pose, std: Pose) -> (Setup, Estimate) {
    let scene = include_str!("../../../testkit/experiments/stop-square50-bar-000/scene.toml");
    let setup = read_scene(scene, "scene.toml").unwrap();
    let fixels = setup.scene.fixels.len();
    let quarters = ContactSlip {
        stick: 0.25,
        left: 0.25,
        right: 0.0,
    };
    let seen = EstimateRow {
        pose: Some(pose),
        contact_pusher: Some(0.5),
        contact_others: Some(vec![0.75; fixels]),
        friction: Some(Friction {
            mu_s: 0.5,
            mu_p: 0.25,
            mu_f: 0.125,
            d_tri: 0.0625,
        }),
        ess: Some(64.0),
        distinct: Some(60),
        modes: vec![BeliefMode {
            weight: 1.0,
            pose,
            std,
        }],
        slip: Some(vec![quarters; 1 + fixels]),
        unsolved: Some(3),
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
        others: fixels,
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
    let log = Log {
        pusher: vec![None, Some(Pose::new(0.25, 0.5, 0.0))],
        ..Log::default()
    };
    let file = File::create(&path).unwrap();
    write_estimate_mcap(file, &estimate, &cloud, &log, &setup).unwrap();
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
                    assert_eq!(numbers, [&at[..], &expected_covariance()].concat());
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
                ("/stickslip/markers", "pusher") => assert_eq!(
                    (numbers[1], &numbers[2..4], numbers[6]),
                    (4.0, &[0.25, 0.5][..], 0.9)
                ),
                (topic, name) => assert_drawn((topic, name), &numbers, (pose, &setup)),
            }
            topics.push((*topic).to_owned());
        }
        let parts = parts_of_others(&setup);
        let plots = topics.iter().filter(|topic| is_plot(topic)).count();
        // of the columns, those whose cells are not empty
        let columns = estimate_columns(&estimate).into_iter();
        let full = columns.filter(|(name, column)| name != "time" && column[1].is_finite());
        assert_eq!(
            (topics.len() - plots, plots),
            (9 + parts, full.count()),
            "{program}: {told}"
        );
    }
}

/// Covariance of the pose at its places in a matrix of six rows.
fn expected_covariance() -> [f64; 36] {
    let mut covariance = [0.0; 36];
    (covariance[0], covariance[7], covariance[35]) = (0.015625, 0.0625, 0.25);
    for (places, value) in [([1, 6], 0.015625), ([5, 30], -0.03125), ([11, 31], 0.0625)] {
        let [upper, lower] = places;
        (covariance[upper], covariance[lower]) = (value, value);
    }
    covariance
}

/// Returns true for the topic of a column of estimate.csv.
fn is_plot(topic: &str) -> bool {
    let name = topic.strip_prefix("/stickslip/");
    name.is_some_and(|name| {
        !name.contains('/') && !["pose", "particles", "markers"].contains(&name)
    })
}

/// Parts of all bodies but the object.
fn parts_of_others(setup: &Setup) -> usize {
    let fixels = setup.scene.fixels.iter().map(|fixel| &fixel.shape);
    let shapes = fixels.chain([&setup.scene.pusher.fingers[0]]);
    shapes.map(|shape| shape.parts().len()).sum()
}

/// Content of one of the messages for viewers without markers, and of one with numbers.
fn assert_drawn((topic, label): (&str, &str), numbers: &[f64], (pose, setup): (Pose, &Setup)) {
    match (topic, label) {
        ("/stickslip/points/object", _) => assert_on_square(numbers, pose, setup),
        ("/stickslip/points/pusher" | "/stickslip/points/touched", _) => {
            assert!(numbers.len() >= 180, "{topic}: {numbers:?}")
        }
        // they are touched
        ("/stickslip/points/fixels", _) => assert!(numbers.is_empty(), "{topic}: {numbers:?}"),
        ("/stickslip/points/particles", _) => {
            assert_eq!(numbers, [0.5, -0.25, 0.0, 0.125, 0.25, 0.0])
        }
        _ => {
            // a column of estimate.csv
            let name = topic.strip_prefix("/stickslip/").expect(topic);
            let known = [
                ("mu_s", 0.5),
                ("d_tri", 0.0625),
                ("contact_pusher", 0.5),
                ("contact_1", 0.75),
                ("ess", 64.0),
                ("unsolved", 3.0),
                ("distinct", 60.0),
                ("mode_x", 0.5),
                ("stick_1", 0.25),
            ];
            let known = known.into_iter().find(|(column, _)| *column == name);
            let expected = known.map_or(numbers[0], |(_, number)| number);
            assert_eq!(numbers, [expected], "{topic}");
            assert!(
                !["std_mu_s", "resampled", "failed"].contains(&name),
                "it is empty"
            );
        }
    }
}

/// Points go around a square whose middle is the origin of the object's frame.
fn assert_on_square(numbers: &[f64], pose: Pose, setup: &Setup) {
    let [Part::Polygon { vertices }] = setup.scene.object.shape.parts() else {
        panic!("the object is one square")
    };
    let half = vertices[0][0].abs();
    let (sin, cos) = (libm::sin(pose.theta), libm::cos(pose.theta));
    let mut sides = [0; 4];
    for point in numbers.chunks(3) {
        let (x, y) = (point[0] - pose.x, point[1] - pose.y);
        let (x, y) = (cos * x + sin * y, cos * y - sin * x);
        assert!((x.abs().max(y.abs()) - half).abs() < 1e-6, "{point:?}");
        let side = if x.abs() > y.abs() { x > 0.0 } else { y > 0.0 };
        sides[2 * usize::from(x.abs() > y.abs()) + usize::from(side)] += 1;
    }
    assert!(sides.iter().all(|count| *count >= 15), "{sides:?}");
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
