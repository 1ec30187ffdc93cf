//! Hands: a jaw that closes about a disc while the camera is off.

use crate::common::{RATE, disc, log, setup};
use stickslip::dynamics::{Body, Pose};
use stickslip::{
    Estimate, FilterModel, Log, Method, Plan, PlanError, Row, RowError, RunError, RunOptions,
    Setup, Tracker, TrackerOptions, Tracking, run,
};

/// Offset of the disc from the middle of the jaw at the start (m).
const OFF: f64 = 0.006;

fn jaw() -> Setup {
    let mut jaw = setup(&[]);
    jaw.scene.pusher.fingers.push(disc(0.005));
    jaw
}

/// Its fingers close at 20 mm/s each and stop at the disc, which they bring to the middle. The
/// camera is off from 0.3 s on; the first finger touches at 0.45 s.
fn closing() -> Log {
    let way = |time: f64| 0.02 * time.min(0.75);
    let object = |time: f64| (time < 0.3).then(|| Pose::new(OFF + 1e-9 * time, 0.0, 0.0));
    let mut log = log(50, object, |time| {
        Some(Pose::new(-0.05 + way(time), 0.0, 0.0))
    });
    let other = log
        .time
        .iter()
        .map(|time| Some(Pose::new(0.05 - way(*time), 0.0, 0.0)));
    log.other_fingers = vec![other.collect()];
    log
}

fn estimate(jaw: &Setup, log: &Log, options: RunOptions) -> Estimate {
    run(jaw, log, &options, &mut |_| ())
        .expect("a run")
        .estimate
}

#[test]
fn a_jaw_brings_the_object_to_its_middle() {
    let (jaw, log) = (jaw(), closing());
    for (method, model) in [
        (Method::Nominal, FilterModel::Robust),
        (Method::ExtendedKalman, FilterModel::Robust),
        (Method::Particle, FilterModel::Robust),
        (Method::Particle, FilterModel::Paper),
    ] {
        let options = RunOptions {
            method,
            model,
            ..RunOptions::default()
        };
        let estimate = estimate(&jaw, &log, options);
        assert_eq!(estimate.others, 1);
        let last = &estimate.rows[49];
        let pose = last.pose.expect("a pose");
        assert!(
            pose.x.abs() < 5e-4 && pose.y.abs() < 1e-3,
            "{method:?} {model:?}: {pose:?}"
        );
        if method == Method::Particle {
            let contacts = last.contact_others.as_ref().expect("contacts");
            let both = last.contact_pusher.expect("a contact").min(contacts[0]);
            // the jaw stops where it touches, and places of its fingers are uncertain
            assert!(both > 0.75, "{model:?}: {both}");
            // the line between the contacts is within both friction cones
            let held = last.held.expect("a probability");
            assert!(held > 0.75, "{model:?}: {held}");
            assert_eq!(estimate.rows[15].held, Some(0.0), "before the second touch");
        }
    }
    // the middle of the fingers stands still, and so does what is glued to it
    let options = RunOptions {
        method: Method::WithPusher,
        ..RunOptions::default()
    };
    let glued = estimate(&jaw, &log, options).rows[49].pose.expect("a pose");
    assert!((glued.x - OFF).abs() < 1e-3, "{glued:?}");
}

#[test]
fn sensors_of_the_fingers_tell_which_one_touches() {
    // the second finger comes first
    let (jaw, mut log) = (jaw(), closing());
    let feels = |from: f64| log.time.iter().map(|time| Some(*time > from)).collect();
    log.tactile = vec![feels(0.74), feels(0.47)];
    for model in [FilterModel::Robust, FilterModel::Paper] {
        let options = RunOptions {
            model,
            ..RunOptions::default()
        };
        let evidence = |log: &Log| {
            let run = run(&jaw, log, &options, &mut |_| ()).expect("a run");
            run.log_evidence.expect("particles")
        };
        let right = evidence(&log);
        let mut swapped = log.clone();
        swapped.tactile.swap(0, 1);
        let wrong = evidence(&swapped);
        assert!(right > wrong + 2.0, "{model:?}: {right} {wrong}");
    }
}

#[test]
fn a_tracker_gives_the_bits_of_a_run() {
    let (jaw, mut log) = (jaw(), closing());
    log.other_fingers[0][20] = None;
    let options = RunOptions {
        tracking: Tracking::Causal,
        ..RunOptions::default()
    };
    let whole = estimate(&jaw, &log, options);
    let options = TrackerOptions::of(&options);
    let mut tracker = Tracker::new(&jaw, &options).expect("a tracker");
    for row in 0..log.len() {
        let estimate = tracker.push(&log.row(row)).expect("a row");
        assert_eq!(estimate, &whole.rows[row], "row {row}");
    }
}

/// A straight way of both fingers towards each other, by `way` (m) each.
fn plan(from: f64, way: f64, steps: usize) -> Plan {
    let place = |side: f64| {
        let at = move |k: usize| side * (from - way * k as f64 / steps as f64);
        (0..=steps).map(|k| Pose::new(at(k), 0.0, 0.0)).collect()
    };
    Plan {
        h: 1.0 / RATE,
        fingers: vec![place(-1.0), place(1.0)],
    }
}

#[test]
fn a_tracker_predicts_how_a_grasp_ends() {
    let (jaw, log) = (jaw(), closing());
    let mut tracker = Tracker::new(&jaw, &TrackerOptions::default()).expect("a tracker");
    let refused = tracker.outcomes(&plan(0.05, 0.0, 1));
    assert_eq!(refused, Err(PlanError::NoPose));
    for row in 0..9 {
        tracker.push(&log.row(row)).expect("a row");
    }
    let before = tracker.estimate().clone();
    let from = 0.05 - 0.02 * 8.0 / RATE;

    let closed = tracker
        .outcomes(&plan(from, from - 0.03, 40))
        .expect("ends");
    let both = vec![Body::Finger(0), Body::Finger(1)];
    assert!(
        closed.held > 0.9 && closed.contacts[0].bodies == both,
        "{closed:?}"
    );
    assert!(
        closed.pose.x.abs() < 1e-3 && closed.spread.x < 1e-3,
        "{closed:?}"
    );
    // half a millimetre short of the first touch, a millimetre beyond
    let apart = tracker
        .outcomes(&plan(from, from - 0.0425, 40))
        .expect("ends");
    assert!(
        apart.lost > 0.9 && (apart.pose.x - OFF).abs() < 5e-4,
        "{apart:?}"
    );
    let pushed = tracker
        .outcomes(&plan(from, from - 0.039, 10))
        .expect("ends");
    assert!(
        pushed.held < 0.1 && pushed.contacts[0].bodies == [Body::Finger(1)],
        "{pushed:?}"
    );
    for ends in [&closed, &apart, &pushed] {
        let sum = ends.held + ends.jammed + ends.resting + ends.moving + ends.lost;
        let sets: f64 = ends.contacts.iter().map(|set| set.probability).sum();
        assert!(
            (sum - 1.0).abs() < 1e-9 && (sets - 1.0).abs() < 1e-9,
            "{ends:?}"
        );
    }

    assert_eq!(tracker.estimate(), &before);
    assert_eq!(tracker.outcomes(&plan(from, from - 0.03, 40)), Ok(closed));
    let mut short = plan(from, 0.01, 5);
    short.fingers[1].pop();
    assert_eq!(
        tracker.outcomes(&short),
        Err(PlanError::Poses {
            finger: 1,
            found: 5,
            first: 6
        })
    );
    short.fingers.pop();
    assert_eq!(
        tracker.outcomes(&short),
        Err(PlanError::Fingers {
            found: 1,
            fingers: 2
        })
    );
}

#[test]
fn a_finger_that_is_not_seen_makes_the_hand_unseen() {
    let (jaw, mut log) = (jaw(), closing());
    // from before the first touch on: nothing closes as far as anybody knows
    let first = (0.3 * RATE) as usize;
    for pose in &mut log.other_fingers[0][first..] {
        *pose = None;
    }
    assert_eq!(
        log.pusher_out_of_sight()
            .iter()
            .filter(|hidden| **hidden)
            .count(),
        50 - first
    );
    let options = RunOptions {
        method: Method::Nominal,
        ..RunOptions::default()
    };
    let last = estimate(&jaw, &log, options).rows[49].pose.expect("a pose");
    assert!((last.x - OFF).abs() < 1e-6, "{last:?}");
}

#[test]
fn fingers_that_the_scene_does_not_have_are_refused() {
    let refused = |setup: &Setup, log: &Log| {
        let options = RunOptions::default();
        run(setup, log, &options, &mut |_| ())
            .expect_err("a refusal")
            .to_string()
    };
    let mut alone = closing();
    alone.other_fingers.clear();
    let message = refused(&jaw(), &alone);
    assert!(
        message.contains("0 fingers") && message.contains("1 [[finger]] table"),
        "{message}"
    );
    let message = refused(&setup(&[]), &closing());
    assert!(
        message.contains("1 finger") && message.contains("0 [[finger]] tables"),
        "{message}"
    );

    let mut short = closing();
    short.other_fingers[0].pop();
    assert!(refused(&jaw(), &short).contains("finger 1"));
    let mut log = closing();
    log.tactile = vec![vec![None; 50]; 3];
    assert!(matches!(
        run(&jaw(), &log, &RunOptions::default(), &mut |_| ()),
        Err(RunError::Sensors {
            sensors: 3,
            fixels: 0,
            fingers: 2
        })
    ));

    let mut tracker = Tracker::new(&setup(&[]), &TrackerOptions::default()).expect("a tracker");
    let row = Row {
        other_fingers: vec![None],
        ..Row::default()
    };
    let error = tracker.push(&row).expect_err("a finger too many");
    assert!(matches!(
        error,
        RowError::Fingers {
            found: 1,
            fingers: 0,
            ..
        }
    ));
}
