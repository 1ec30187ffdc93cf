//! Poses whose angles are wrapped to one turn, as trackers of tags and quaternions give them.

use std::f64::consts::{PI, TAU};

use crate::common::{log, setup};
use stickslip::dynamics::{Part, Pose, Shape};
use stickslip::{Estimate, Log, Method, RunOptions, Setup, Tracker, TrackerOptions, Tracking, run};

/// The angle in (−π, π] that equals `angle` on the circle (rad).
fn in_one_turn(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

/// A bar at about half a turn pushes a disc, both of which wobble by less than their noise. All
/// angles are wrapped to one turn: they jump from row to row. The poses of the object are true.
fn push() -> (Setup, Log) {
    let bar = [[-5e-3, -0.02], [5e-3, -0.02], [5e-3, 0.02], [-5e-3, 0.02]];
    let mut setup = setup(&[]);
    setup.scene.pusher.fingers[0] = Shape::new(vec![Part::Polygon {
        vertices: bar.to_vec(),
    }])
    .expect("a bar");
    let wobble = |time: f64| 2e-3 * ((7.3 * time).fract() - 0.5);
    let bar = |time: f64| Some(Pose::new(-0.036 + 0.02 * time, 0.0, PI + wobble(time)));
    let start = |_| Some(Pose::new(0.0, 0.0, PI));
    let mut log = log(90, start, bar);
    let options = RunOptions {
        method: Method::Nominal,
        ..RunOptions::default()
    };
    let truth = run(&setup, &log, &options, &mut |_| ()).expect("a simulation");
    for (row, truth) in truth.estimate.rows.iter().enumerate() {
        log.object[row] = truth.pose.map(|pose| Pose {
            theta: in_one_turn(pose.theta + wobble(log.time[row])),
            ..pose
        });
        log.pusher[row] = log.pusher[row].map(|pose| Pose {
            theta: in_one_turn(pose.theta),
            ..pose
        });
    }
    for poses in [&log.object, &log.pusher] {
        let theta = |row: usize| poses[row].expect("a pose").theta;
        let jumps = (1..90).filter(|row| (theta(*row) - theta(row - 1)).abs() > 6.0);
        assert!(jumps.count() > 10);
    }
    (setup, log)
}

#[track_caller]
fn assert_near_truth(estimate: &Estimate, log: &Log) {
    let mut before = None;
    for (row, estimate) in estimate.rows.iter().enumerate() {
        let (found, truth) = (
            estimate.pose.expect("a pose"),
            log.object[row].expect("a pose"),
        );
        let away = (found.x - truth.x).hypot(found.y - truth.y);
        let turn = in_one_turn(found.theta - truth.theta);
        assert!(
            away < 5e-4 && turn.abs() < 0.01,
            "row {row}: {found:?} {truth:?}"
        );
        let before = before.replace(found.theta).unwrap_or(found.theta);
        assert!(
            (found.theta - before).abs() < 0.1,
            "row {row} is not unwrapped"
        );
    }
    let last = estimate.rows[89].pose.expect("a pose");
    assert!(last.x > 0.04, "the bar pushes: {last:?}");
}

#[test]
fn wrapped_angles_are_tracked_by_every_method() {
    let (setup, log) = push();
    for tracking in [Tracking::Smoothed, Tracking::Causal] {
        for method in [Method::Particle, Method::ExtendedKalman, Method::Kalman] {
            let options = RunOptions {
                method,
                tracking,
                particles: 60,
                ..RunOptions::default()
            };
            let run = run(&setup, &log, &options, &mut |_| ()).expect("a run");
            assert_near_truth(&run.estimate, &log);
        }
    }
}

#[test]
fn wrapped_angles_row_by_row_give_the_bits_of_the_whole_log() {
    let (setup, log) = push();
    let options = RunOptions {
        particles: 60,
        tracking: Tracking::Causal,
        ..RunOptions::default()
    };
    let whole = run(&setup, &log, &options, &mut |_| ()).expect("a run");
    let options = TrackerOptions {
        late: 0.2,
        ..TrackerOptions::of(&options)
    };
    let mut tracker = Tracker::new(&setup, &options).expect("a tracker");
    for row in 0..log.len() {
        let estimate = tracker.push(&log.row(row)).expect("an estimate");
        assert_eq!(*estimate, whole.estimate.rows[row], "row {row}");
    }
    assert_eq!(tracker.pusher_poses_left_out(), 0);
}
