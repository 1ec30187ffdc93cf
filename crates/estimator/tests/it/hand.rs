//! Hands: a jaw that closes about a disc in the dark.

use crate::common::{RATE, disc, log, setup};
use stickslip::dynamics::Pose;
use stickslip::{
    Estimate, FilterModel, Log, Method, Row, RowError, RunError, RunOptions, Setup, Tracker,
    TrackerOptions, Tracking, run,
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
            assert!(both > 0.9, "{model:?}: {both}");
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
