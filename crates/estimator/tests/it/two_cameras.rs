//! Two cameras whose frames differ by far more than their noise: their poses alternate.

use crate::common::setup;
use stickslip::diagnosis::{Finding, Severity, Subject, diagnose};
use stickslip::dynamics::Pose;
use stickslip::{EstimateRow, Log, RunOptions, run};
use stickslip_filter::Streams;

/// Rows a second, and their number.
const RATE: f64 = 60.0;
const ROWS: usize = 600;

/// Noise of both cameras (m), and distance of their frames along y.
const NOISE: f64 = 3e-4;
const APART: f64 = 5e-3;

/// Speed of the pusher (m/s), which pushes the disc from 2 to 4 s.
const SPEED: f64 = 0.02;

/// Rows in which the second camera sees the object, and whether the first does.
#[derive(Clone, Copy, Debug)]
struct Seen {
    second_from: usize,
    first_until: usize,
    second_until: usize,
}

fn place(time: f64) -> f64 {
    SPEED * (time.clamp(2.0, 4.0) - 2.0)
}

/// Poses of one row after the other by the first camera, whose frame is true, and by the second.
/// While one of them does not see the object, all poses are the other one's.
fn log(seen: Seen, noise: f64) -> Log {
    let mut log = Log::default();
    for k in 0..ROWS {
        let time = k as f64 / RATE;
        let [x, y, turn] = Streams::new(3).normals::<3>(k as u64, 0, 0);
        let [px, py] = Streams::new(4).normals::<2>(k as u64, 0, 0);
        let second = match (
            k < seen.first_until,
            (seen.second_from..seen.second_until).contains(&k),
        ) {
            (true, true) => k % 2 == 1,
            (_, second) => second,
        };
        let aside = if second { APART } else { 0.0 };
        log.time.push(time);
        log.object.push(Some(Pose::new(
            place(time) + noise * x,
            aside + noise * y,
            5e-3 * turn,
        )));
        let pusher = -0.035 + SPEED * (time.min(4.0) - 2.0);
        log.pusher
            .push(Some(Pose::new(pusher + 1e-4 * px, 1e-4 * py, 0.0)));
    }
    log
}

fn tracked(log: &Log) -> Vec<EstimateRow> {
    let run = run(&setup(&[]), log, &RunOptions::default(), &mut |_| ());
    run.expect("a run").estimate.rows
}

/// Distance along y from a place, in standard deviations.
fn off(row: &EstimateRow, y: f64) -> f64 {
    let (pose, spread) = (row.pose.expect("a pose"), row.spread.expect("a spread"));
    (pose.y - y).abs() / spread.pose.y
}

#[test]
fn two_cameras_from_the_start_are_covered_by_the_spread_even_after_one_stops() {
    let seen = Seen {
        second_from: 0,
        first_until: ROWS,
        second_until: 450,
    };
    let rows = tracked(&log(seen, NOISE));
    for (k, row) in rows.iter().enumerate().skip(30) {
        assert!(off(row, 0.0) < 2.0, "row {k}: {row:?}");
    }
}

#[test]
fn second_camera_that_comes_later_leaves_the_estimate_near_one_and_then_near_the_one_left() {
    // it comes before the push, and during it
    for second_from in [60, 180] {
        for [first_until, second_until] in [[ROWS, 450], [450, ROWS]] {
            let seen = Seen {
                second_from,
                first_until,
                second_until,
            };
            let rows = tracked(&log(seen, NOISE));
            let left = if second_until == ROWS { APART } else { 0.0 };
            for (k, row) in rows.iter().enumerate().skip(60) {
                let y = row.pose.expect("a pose").y;
                let away = match k {
                    ..450 => y.abs().min((y - APART).abs()),
                    450..460 => 0.0,
                    _ => (y - left).abs(),
                };
                assert!(away < 2.0 * NOISE, "{seen:?}, row {k}: {away}, {row:?}");
            }
        }
    }
}

#[test]
fn camera_twice_as_noisy_as_stated_is_averaged() {
    let one = Seen {
        second_from: ROWS,
        first_until: ROWS,
        second_until: ROWS,
    };
    let rows = tracked(&log(one, 2.0 * NOISE));
    for row in &rows[60..] {
        assert!(row.spread.expect("a spread").pose.y < NOISE, "{row:?}");
    }
}

fn faults(log: &Log) -> Vec<Finding> {
    let mut findings = diagnose(&setup(&[]), log);
    findings.retain(|finding| finding.severity > Severity::Ok);
    findings
}

#[test]
fn poses_of_two_places_are_named_with_distance_and_share() {
    let seen = Seen {
        second_from: 0,
        first_until: ROWS,
        second_until: 450,
    };
    let [fault] = &faults(&log(seen, NOISE))[..] else {
        panic!("{:#?}", faults(&log(seen, NOISE)));
    };
    assert_eq!(
        (fault.severity, fault.subject),
        (Severity::Problem, Subject::ObjectPoses)
    );
    assert!(fault.found.contains("two places 5.0 mm"), "{fault}");
    assert!(fault.found.contains("in 7"), "{fault}");
}

#[test]
fn wrong_poses_here_and_there_are_no_second_place() {
    let one = Seen {
        second_from: ROWS,
        first_until: ROWS,
        second_until: ROWS,
    };
    let mut log = log(one, NOISE);
    for (k, pose) in log.object.iter_mut().enumerate().skip(1).step_by(10) {
        let way = k as f64;
        let pose = pose.as_mut().expect("a pose");
        pose.x += 0.02 * libm::cos(way);
        pose.y += 0.02 * libm::sin(way);
    }
    let alternate = |fault: &Finding| fault.found.contains("alternate");
    assert!(!faults(&log).iter().any(alternate), "{:#?}", faults(&log));
}
