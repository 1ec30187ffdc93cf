//! A pusher whose poses are missing: its effect on the object meanwhile, and its return.

use crate::common::{know_feet, setup};
use stickslip::dynamics::Pose;
use stickslip::*;

/// Speed of the pusher (m/s), time at which it starts (s), and distance of its centre behind that
/// of the disc.
const SPEED: f64 = 0.02;
const START: f64 = 0.4;
const BEHIND: f64 = 0.035;

/// x of a disc that has been pushed since [`START`].
fn place(time: f64) -> f64 {
    SPEED * (time - START).max(0.0)
}

/// So many rows at `rate` (Hz) of a push that goes on to the end, without the object and without
/// the pusher where these are `hidden` at a time (s).
fn push(rows: usize, rate: f64, hidden: impl Fn(f64) -> [bool; 2]) -> Log {
    let noise = |k: usize| 3e-4 * libm::sin(7.0 * (k * k) as f64);
    let mut log = Log::default();
    for k in 0..rows {
        let time = k as f64 / rate;
        let [object, pusher] = hidden(time);
        let seen = Pose::new(place(time) + noise(k), noise(k + 77), 0.0);
        let pusher_pose = Pose::new(-BEHIND + place(time), 0.001, 0.0);
        log.time.push(time);
        log.object.push((!object).then_some(seen));
        log.pusher.push((!pusher).then_some(pusher_pose));
    }
    log
}

/// Errors (m) and standard deviations (m) of x, row by row.
fn tracked(log: &Log, tracking: Tracking) -> Vec<[f64; 2]> {
    // a disc on unknown feet may come off to one side
    let mut setup = setup(&[]);
    know_feet(&mut setup);
    let options = RunOptions {
        tracking,
        ..RunOptions::default()
    };
    let run = run(&setup, log, &options, &mut |_| ()).expect("a run");
    assert_eq!(run.collapses, 0, "{tracking:?}");
    let rows = run.estimate.rows.iter().zip(&log.time);
    rows.map(|(row, time)| {
        let error = row.pose.expect("a pose").x - place(*time);
        [error, row.spread.expect("a spread").pose.x]
    })
    .collect()
}

#[test]
fn a_pusher_that_is_seen_again_throws_nothing_ahead() {
    // a tracker at 200 Hz that misses twenty poses; the step to the next one would be 21 times as
    // fast
    let lost = 1.5..1.6;
    let log = push(400, 200.0, |time| [time >= 1.4, lost.contains(&time)]);
    let rows = tracked(&log, Tracking::Causal);
    for (k, [error, _]) in rows.iter().enumerate() {
        // as far as the pusher goes unseen
        assert!(error.abs() < 2.5e-3, "row {k}: {error}");
    }
    let [last, _] = rows[399];
    assert!(last.abs() < 1e-3, "{last}");
}

#[test]
fn where_pusher_and_object_are_hidden_together_the_push_may_have_gone_on() {
    for tracking in [Tracking::Smoothed, Tracking::Causal] {
        let lost = 1.5..2.5;
        let log = push(120, 30.0, |time| [lost.contains(&time); 2]);
        for (k, [error, std]) in tracked(&log, tracking).into_iter().enumerate() {
            assert!(
                error.abs() < 2.5 * std,
                "{tracking:?}, row {k}: {error}, {std}"
            );
            // it pushes on as likely as not; where it is seen, that is known at once
            let most = if lost.contains(&log.time[k]) {
                0.012
            } else {
                1e-3
            };
            assert!(error.abs() < most, "{tracking:?}, row {k}: {error}");
        }
    }
}

#[test]
fn a_pusher_that_stood_when_it_was_last_seen_has_been_lifted() {
    for tracking in [Tracking::Smoothed, Tracking::Causal] {
        // nothing has moved yet when both are lost, a pusher next to the object
        let log = push(90, 30.0, |time| [time >= 0.3; 2]);
        let rows = tracked(&log, tracking);
        let [before, last] = [rows[8], rows[89]].map(|[_, std]| std);
        assert!(last < 1.5 * before, "{tracking:?}: {before}, {last}");
    }
}

#[test]
fn a_pusher_that_is_seldom_seen_pushes_between_its_poses() {
    // four poses a second, and then some that come a little later than the median
    for tracking in [Tracking::Smoothed, Tracking::Causal] {
        let mut log = push(40, 4.0, |time| [time >= 5.0, false]);
        for (k, time) in log.time.iter_mut().enumerate() {
            *time += if k % 3 == 0 { 0.03 } else { 0.0 };
        }
        log.pusher = log
            .time
            .iter()
            .map(|time| Some(Pose::new(-BEHIND + place(*time), 0.001, 0.0)))
            .collect();
        let track = PusherTrack::new(&log, setup(&[]).camera.as_ref(), tracking).expect("a track");
        // causally, six poses tell how often they come
        let moves = (7..39).filter(|&row| track.moves_after(row)).count();
        assert!(moves > 28, "{tracking:?}: {moves}");
        let [error, std] = tracked(&log, tracking)[39];
        assert!(
            error.abs() < 2e-3 && std < 3.5e-3,
            "{tracking:?}: {error}, {std}"
        );
    }
}

/// Largest error (m) in x while the pusher's poses are missing for a second, and the mean standard
/// deviation. The pusher moves the object on in that second, or is lifted off it.
fn without_pusher(moves_on: bool, tracking: Tracking) -> (f64, f64) {
    let setup = setup(&[]);
    let (lost, back) = (2.0, 3.0);
    let place = |time: f64| {
        let rested = (time.min(back) - lost).max(0.0);
        0.02 * ((time - 0.4).max(0.0) - if moves_on { 0.0 } else { rested })
    };
    let noise = |k: usize| 3e-4 * libm::sin(7.0 * (k * k) as f64);
    let mut log = Log::default();
    for k in 0..120 {
        let time = k as f64 / 30.0;
        let object = Pose::new(place(time) + noise(k), noise(k + 77), 0.0);
        let pusher = Pose::new(-0.035 + place(time), 0.001, 0.0);
        log.time.push(time);
        log.object.push(Some(object));
        log.pusher
            .push(Some(pusher).filter(|_| !(lost..back).contains(&time)));
    }
    let options = RunOptions {
        tracking,
        ..RunOptions::default()
    };
    let run = run(&setup, &log, &options, &mut |_| ()).expect("a run");
    assert_eq!(run.collapses, 0);
    let (mut most, mut sum) = (0.0_f64, 0.0);
    for (row, time) in run.estimate.rows.iter().zip(&log.time).skip(60).take(30) {
        most = most.max((row.pose.expect("a pose").x - place(*time)).abs());
        sum += row.spread.expect("a spread").pose.x;
    }
    (most, sum / 30.0)
}

#[test]
fn while_nobody_sees_the_pusher_the_camera_says_whether_it_moves_the_object() {
    for tracking in [Tracking::Smoothed, Tracking::Causal] {
        let (moved, _) = without_pusher(true, tracking);
        assert!(moved < 1e-3, "{tracking:?}: {moved}");
        let (rested, spread) = without_pusher(false, tracking);
        assert!(
            rested < 7e-4 && spread < 3e-4,
            "{tracking:?}: {rested}, {spread}"
        );
    }
}

#[test]
fn a_pusher_that_was_on_its_way_when_all_went_dark_may_have_come() {
    // it would touch the object 0.25 s after both are lost
    let (from, lost) = (0.5, 0.25..1.75);
    let reach = |time: f64| SPEED * (time - from).max(0.0);
    let mut log = Log::default();
    for k in 0..105 {
        let time = k as f64 / 30.0;
        let noise = |n: usize| 3e-4 * libm::sin(7.0 * ((k + n) * (k + n)) as f64);
        let hidden = lost.contains(&time);
        let object = Pose::new(reach(time), noise(77), 0.0);
        let pusher = Pose::new(-BEHIND + SPEED * (time - from), 0.0, 0.0);
        log.time.push(time);
        log.object.push((!hidden).then_some(object));
        log.pusher.push((!hidden).then_some(pusher));
    }
    let run = run(&setup(&[]), &log, &RunOptions::default(), &mut |_| ()).expect("a run");
    for (row, time) in run.estimate.rows.iter().zip(&log.time) {
        let error = row.pose.expect("a pose").x - reach(*time);
        let std = row.spread.expect("a spread").pose.x;
        assert!(error.abs() < 3.0 * std, "{time}: {error}, {std}");
        let most = if lost.contains(time) { 0.03 } else { 2e-3 };
        assert!(error.abs() < most, "{time}: {error}");
    }
}

#[test]
fn a_pusher_that_comes_back_inside_an_object_throws_it_nowhere() {
    // it stood when both were lost, so the object is taken to rest; then it pushed the object by 30
    // mm
    let way = |time: f64| 0.06 * (time - 1.0).clamp(0.0, 0.5);
    let mut log = Log::default();
    for k in 0..360 {
        let time = k as f64 / 120.0;
        let hidden = (0.5..1.6).contains(&time);
        let noise = |n: usize| 3e-4 * libm::sin(7.0 * ((k + n) * (k + n)) as f64);
        let object = Pose::new(way(time) + noise(5), noise(77), 0.0);
        let pusher = Pose::new(-BEHIND - 1e-4 + way(time), 0.0, 0.0);
        log.time.push(time);
        log.object.push((!hidden).then_some(object));
        log.pusher.push((!hidden).then_some(pusher));
    }
    let run = run(&setup(&[]), &log, &RunOptions::default(), &mut |_| ()).expect("a run");
    for (row, time) in run.estimate.rows.iter().zip(&log.time) {
        let error = row.pose.expect("a pose").x - way(*time);
        let std = row.spread.expect("a spread").pose;
        assert!(
            std.x > 1e-6 && std.y > 1e-6 && std.theta > 1e-6,
            "{time}: {std:?}"
        );
        // the first pose is accepted
        let most = if *time < 1.6 { 0.035 } else { 1.5e-3 };
        assert!(error.abs() < most, "{time}: {error}");
    }
}
