//! Rows of a tracker: each measurement is used once, for what it reveals, and the estimate is true
//! of the particles.

use std::num::NonZero;

use crate::common::{log, setup, slippery, sticky};
use stickslip::dynamics::Pose;
use stickslip::*;

/// Pose of a pusher that is far away.
const AWAY: Option<Pose> = Some(Pose {
    x: -0.1,
    y: 0.0,
    theta: 0.0,
});

fn tracker(setup: &Setup, particles: usize) -> Tracker<'static> {
    let options = TrackerOptions {
        particles,
        ..TrackerOptions::default()
    };
    Tracker::new(setup, &options).expect("a tracker")
}

/// A disc that slips past a fixel, in a scene where everything sticks.
fn sticky_and_slippery() -> (Setup, Log) {
    let (slippery, log) = slippery();
    (sticky(&slippery, 0.8), log)
}

#[test]
fn the_effective_sample_size_is_that_of_the_weights() {
    let (setup, log) = sticky_and_slippery();
    let mut tracker = tracker(&setup, 20);
    for k in 0..log.len() {
        let row = Row {
            object: log.object[k].filter(|_| k < 5),
            ..log.row(k)
        };
        let estimate = tracker.push(&row).expect("a row").clone();
        if k > 0 {
            let particles = tracker.particles().expect("particles");
            let squares: f64 = particles.weights().iter().map(|w| w * w).sum();
            let ess = estimate.ess.expect("a size");
            assert!((ess * squares - 1.0).abs() < 1e-9, "row {k}: {ess}");
        }
    }
}

#[test]
fn copies_made_for_another_number_of_particles_are_no_distinct_ones() {
    let (setup, log) = sticky_and_slippery();
    let mut tracker = tracker(&setup, 64);
    for k in 0..30 {
        let _ = tracker.push(&log.row(k)).expect("a row");
    }
    let many = |_: StepSize| NonZero::new(500).expect("not 0");
    let estimate = tracker.push_sized(&log.row(30), many).expect("a row");
    assert!(estimate.distinct.expect("a count") <= 64, "{estimate:?}");
    assert_eq!(estimate.resampled, Some(true));
}

/// Spread of x after a first pose; `again` shows that pose in the rows after it, or not.
fn spread_after(mut again: impl FnMut(&mut Tracker<'_>, Row)) -> f64 {
    let mut setup = setup(&[]);
    setup.uncertainty.camera_noise = 0.0;
    let mut tracker = tracker(&setup, 500);
    let row = |time: f64, object| Row {
        time,
        object,
        pusher: AWAY,
        ..Row::default()
    };
    let _ = tracker
        .push(&row(0.0, Some(Pose::default())))
        .expect("a row");
    again(&mut tracker, row(0.1, Some(Pose::default())));
    let estimate = tracker.push(&row(0.2, None)).expect("a row");
    estimate.spread.expect("a spread").pose.x
}

#[test]
fn a_frame_that_comes_again_tells_nothing_new() {
    let once = spread_after(|_, _| ());
    let first_again = spread_after(|tracker, row| {
        let estimate = tracker.push(&row).expect("a row");
        assert!(!estimate.visual);
    });
    let late_again = spread_after(|tracker, row| {
        let later = Row {
            object: None,
            ..row.clone()
        };
        let _ = tracker.push(&later).expect("a row");
        let _ = tracker.push(&row).expect("a late row");
    });
    for again in [first_again, late_again] {
        assert!((again / once - 1.0).abs() < 0.1, "{again}, {once}");
    }
}

#[test]
fn a_camera_whose_every_pose_comes_late_is_believed_as_one_that_is_on_time() {
    let setup = setup(&[]);
    for late in [false, true] {
        let mut tracker = tracker(&setup, 500);
        for k in 0..60 {
            // moved by hand at row 20
            let x = if k < 20 { 0.0 } else { 0.05 };
            let object = Some(Pose::new(x + 1e-6 * f64::from(k), 0.0, 0.0));
            let time = f64::from(k) / 30.0;
            let on_time = Row {
                time,
                object,
                pusher: AWAY,
                ..Row::default()
            };
            if !late || k == 0 {
                let _ = tracker.push(&on_time).expect("a row");
                continue;
            }
            let unseen = Row {
                object: None,
                ..on_time.clone()
            };
            let _ = tracker.push(&unseen).expect("a row");
            let after = Row {
                time: time - 0.01,
                ..on_time
            };
            let _ = tracker.push(&after).expect("a late row");
        }
        let x = tracker.estimate().pose.expect("a pose").x;
        assert!((x - 0.05).abs() < 1e-3, "late {late}: {x}");
        assert_eq!(tracker.collapses(), 1, "late {late}");
    }
}

/// Weighing by a pose alone would leave a quarter of the particles, row after row.
#[test]
fn poses_that_come_late_or_beside_a_step_move_particles_as_those_on_time_do() {
    let setup = setup(&[]);
    let log = two_clocks(1e-4);
    // the pusher's rows, with the pose of each 10 ms late, or next to it in a row that makes no
    // step
    for late in [Some(0.01), None] {
        let mut tracker = tracker(&setup, 500);
        let mut few = 500.0_f64;
        for k in (0..log.len()).step_by(2) {
            let object = log.object[k];
            let row = Row {
                object: object.filter(|_| k == 0),
                ..log.row(k)
            };
            let _ = tracker.push(&row).expect("a row");
            if k == 0 {
                continue;
            }
            let time = row.time + late.map_or(1e-4, |late: f64| -late);
            let seen = Row {
                time,
                object,
                ..row
            };
            let estimate = tracker.push(&seen).expect("a row");
            assert!(
                estimate.ancestors.expect("a count") > 100,
                "{late:?}, row {k}"
            );
            few = few.min(estimate.ess.expect("a size"));
        }
        assert!(few > 150.0, "{late:?}: {few}");
    }
}

/// The object is jammed between pusher and fixel, as the camera shows it, and the pusher's log
/// creeps on; one pose is wrong.
#[test]
fn a_pusher_that_contradicts_all_particles_makes_no_camera_pose_believed() {
    let setup = setup(&[[0.0351, 0.0]]);
    for speed in [0.005, 0.01] {
        let mut tracker = tracker(&setup, 500);
        for k in 0..60 {
            let time = f64::from(k) / 30.0;
            let jams = speed * (time - 0.5_f64).max(0.0);
            let x = if k == 50 { 0.05 } else { 1e-6 * f64::from(k) };
            let row = Row {
                time,
                object: Some(Pose::new(x, 0.0, 0.0)),
                pusher: Some(Pose::new(-0.0352 + jams, 0.0, 0.0)),
                ..Row::default()
            };
            let estimate = tracker.push(&row).expect("a row");
            let x = estimate.pose.expect("a pose").x;
            assert!(x.abs() < 5e-3, "speed {speed}, row {k}: {x}");
        }
        assert_eq!(tracker.collapses(), 0, "speed {speed}");
    }
}

#[test]
fn a_row_says_the_same_of_the_learning_particles_whether_more_poses_come_or_not() {
    let mut setup = setup(&[[0.0452, 0.0]]);
    setup.scene.pusher.stall_force = None;
    let object = |time: f64| Some(Pose::new((0.02 * time).min(0.0102) + 1e-7 * time, 0.0, 0.0));
    let pusher = |time: f64| Some(Pose::new(-0.0351 + 0.02 * time, 0.0, 0.0));
    let mut log = log(90, object, pusher);
    log.object[30..].fill(None);
    let options = RunOptions {
        particles: 100,
        tracking: Tracking::Causal,
        ..RunOptions::default()
    };
    let whole = run(&setup, &log, &options, &mut |_| ()).expect("a run");
    let mut tracker = tracker(&setup, 100);
    for (k, row) in whole.estimate.rows.iter().enumerate() {
        let estimate = tracker.push(&log.row(k)).expect("a row");
        assert_eq!(estimate, row, "row {k}");
    }
    assert!(whole.unsolved > 0);
}

/// ln of the likelihood of a reading of 1 far from all fixels, after a second of such readings and
/// ten seconds of so many rows. These are `silent`: without a reading of the sensor, or without
/// readings.
fn false_alarm(rows_between: usize, silent: &[Option<bool>]) -> f64 {
    let setup = setup(&[[0.2, 0.0]]);
    let mut tracker = tracker(&setup, 50);
    let mut push = |time: f64, tactile: &[Option<bool>]| {
        let before = tracker.log_evidence();
        let row = Row {
            time,
            object: (time == 0.0).then(Pose::default),
            pusher: Some(Pose::new(-0.2, 0.0, 0.0)),
            tactile: tactile.to_vec(),
            ..Row::default()
        };
        let _ = tracker.push(&row).expect("a row");
        tracker.log_evidence() - before
    };
    for k in 0..30 {
        let _ = push(f64::from(k) / 30.0, &[Some(true)]);
    }
    for k in 1..=rows_between {
        let _ = push(1.0 + 10.0 * k as f64 / rows_between as f64, silent);
    }
    push(11.1, &[Some(true)])
}

#[test]
fn a_stuck_sensor_gets_free_whether_it_is_read_or_not() {
    let few = false_alarm(4, &[None]);
    for silent in [&[None][..], &[]] {
        let many = false_alarm(300, silent);
        assert!((few - many).abs() < 0.02, "{few}, {many}");
        assert!(many < -3.0, "{many}");
    }
}

/// Rows of a camera, each followed `later` (s) by a row of a faster tracker that has the pusher
/// alone.
fn two_clocks(later: f64) -> Log {
    let place = |time: f64| 0.02 * (time - 0.4_f64).max(0.0);
    let noise = |k: usize| 3e-4 * libm::sin(7.0 * (k * k) as f64);
    let mut log = Log::default();
    for k in 0..150 {
        let time = k as f64 / 30.0;
        let object = Pose::new(place(time) + noise(k), noise(k + 77), 0.0);
        let pusher = |time: f64| Some(Pose::new(-0.035 + place(time), 0.001, 0.0));
        log.time.extend([time, time + later]);
        log.object.extend([Some(object), None]);
        log.pusher.extend([pusher(time), pusher(time + later)]);
    }
    log
}

#[test]
fn rows_a_moment_apart_throw_nothing_apart() {
    let setup = setup(&[]);
    for later in [1e-9, 3e-6, 1e-4, 1e-3] {
        let log = two_clocks(later);
        for tracking in [Tracking::Smoothed, Tracking::Causal] {
            let options = RunOptions {
                tracking,
                ..RunOptions::default()
            };
            let run = run(&setup, &log, &options, &mut |_| ()).expect("a run");
            for (row, time) in run.estimate.rows.iter().zip(&log.time) {
                let error = row.pose.expect("a pose").x - 0.02 * (time - 0.4).max(0.0);
                assert!(
                    error.abs() < 1e-3,
                    "{later} s apart, at {time} s: {error} m"
                );
            }
            assert_eq!(run.collapses, 0, "{later} s apart");
        }
    }
}

#[test]
fn a_row_that_no_step_leads_to_touches_for_all_methods_what_the_one_before_did() {
    let setup = setup(&[]);
    // the object's first pose stands in the row before the one that makes no step
    let log = two_clocks(1e-4);
    let methods = [Method::Nominal, Method::ExtendedKalman, Method::Particle];
    for method in methods {
        let options = RunOptions {
            method,
            ..RunOptions::default()
        };
        let rows = run(&setup, &log, &options, &mut |_| ()).expect("a run");
        let rows = rows.estimate.rows;
        for pair in rows[2..].chunks_exact(2) {
            let [seen, stepless] = [&pair[0], &pair[1]].map(|row| row.contact_pusher);
            assert_eq!(seen, stepless, "{method:?}");
        }
        let last = rows.last().and_then(|row| row.contact_pusher);
        assert!(last.expect("a contact") > 0.5, "{method:?}");
    }
}

#[test]
fn an_object_turned_round_by_hand_is_where_the_camera_shows_it_at_once() {
    let setup = setup(&[]);
    let mut tracker = tracker(&setup, 500);
    let noise = |k: usize| 3e-4 * libm::sin(7.0 * (k * k) as f64);
    for k in 0..120 {
        let time = k as f64 / 30.0;
        let place = 0.02 * (time.min(1.5) - 0.4).max(0.0);
        // the camera is off for half a second; then the object has been turned by half a turn, as
        // near as a hand can
        let turn = if time < 2.5 {
            0.0
        } else {
            std::f64::consts::PI
        };
        let turned = Pose::new(place + noise(k), noise(k + 77), turn + 9.0 * noise(k + 5));
        let row = Row {
            time,
            object: Some(turned).filter(|_| !(2.0..2.5).contains(&time)),
            pusher: Some(Pose::new(-0.0355 + place, 0.001, 0.0)),
            ..Row::default()
        };
        let estimate = tracker.push(&row).expect("a row");
        if time > 3.0 {
            let theta = estimate.pose.expect("a pose").theta;
            let spread = estimate.spread.expect("a spread").pose.theta;
            let off = wrapped(theta - std::f64::consts::PI).abs();
            assert!(off < 4e-3 && spread < 4e-3, "at {time} s: {off}, {spread}");
        }
    }
    assert!(tracker.collapses() > 0);
}
