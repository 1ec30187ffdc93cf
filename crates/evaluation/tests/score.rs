//! What an experiment is scored against, by motions that are known in closed form.

use stickslip::dynamics::Pose;
use stickslip::{Estimate, EstimateRow, Log, Setup};
use stickslip_evaluation::{Reference, score};
use stickslip_formats::{Experiment, Truth, TruthFacts, read_scene};

fn setup() -> Setup {
    read_scene(
        include_str!("../../formats/tests/full_scene.toml"),
        "scene.toml",
    )
    .expect("a scene")
}

/// Along a line at constant speed, turning steadily.
fn moving(time: f64) -> Pose {
    Pose::new(0.02 * time, 0.1 - 0.01 * time, 3.0 + 0.5 * time)
}

/// Rows at 30 Hz, as a log prints their times: in microseconds.
fn log(rows: u32) -> Log {
    let time: Vec<f64> = (0..rows)
        .map(|row| (1e6 * f64::from(row) / 30.0).round() / 1e6)
        .collect();
    let object = time
        .iter()
        .map(|time| {
            Some(Pose {
                x: moving(*time).x + 1.0,
                ..moving(*time)
            })
        })
        .collect();
    Log {
        pusher: vec![None; time.len()],
        time,
        object,
        ..Log::default()
    }
}

fn truth(step: f64, rows: u32) -> Truth {
    let time: Vec<f64> = (0..rows).map(|row| step * f64::from(row)).collect();
    Truth {
        pose: time.iter().map(|time| moving(*time)).collect(),
        time,
        ..Truth::default()
    }
}

fn assert_near(found: Pose, expected: Pose) {
    let error = (found.x - expected.x)
        .abs()
        .max((found.y - expected.y).abs())
        .max((found.theta - expected.theta).abs());
    assert!(error < 5e-5, "{found:?}, not {expected:?}");
}

#[test]
fn reference_is_the_truth_between_its_rows_and_ends_with_it() {
    let log = log(31);
    // rows every 0.07 s up to 0.7 s: few of them at the log's times, and none after
    let facts = TruthFacts {
        first_pusher_contact: Some(7),
        ..TruthFacts::default()
    };
    let experiment = Experiment::new(setup(), log.clone(), Some(truth(0.07, 11)), facts)
        .expect("as many sensors as fixels");
    let reference = Reference::of(&experiment);
    assert_eq!(
        (reference.latency, reference.first_pusher_contact),
        (0.0, Some(7))
    );
    for (time, pose) in log.time.iter().zip(reference.pose) {
        match pose {
            Some(pose) => assert_near(pose, moving(*time)),
            None => assert!(*time > 0.7, "{time} s has none"),
        }
    }
}

#[test]
fn reference_of_a_log_without_truth_is_its_own_poses_as_the_camera_delays_them() {
    let mut setup = setup();
    let latency = 0.16;
    setup
        .camera
        .iter_mut()
        .for_each(|camera| camera.latency = latency);
    let experiment = Experiment::new(setup, log(5), None, TruthFacts::default())
        .expect("as many sensors as fixels");
    let reference = Reference::of(&experiment);
    assert_eq!(
        (&reference.pose, reference.latency),
        (&experiment.log.object, latency)
    );
}

/// The squared weighted RMSE is dx² + dy² + r_v² dθ² for a constant error.
#[test]
fn score_of_a_constant_error_is_its_size() {
    let log = log(31);
    let experiment = Experiment::new(
        setup(),
        log.clone(),
        Some(truth(1.0 / 120.0, 121)),
        TruthFacts::default(),
    )
    .expect("a log");
    let wrong = |time: &f64| {
        Pose::new(
            moving(*time).x + 3e-3,
            moving(*time).y - 4e-3,
            moving(*time).theta + 0.1,
        )
    };
    let rows = log
        .time
        .iter()
        .map(|time| EstimateRow {
            pose: Some(wrong(time)),
            ..EstimateRow::default()
        })
        .collect();
    let estimate = Estimate {
        time: log.time.clone(),
        rows,
        ..Estimate::default()
    };
    let radius = experiment.setup.virtual_radius();
    let scores = score(&estimate, &Reference::of(&experiment), &[false; 31], radius);
    let expected = (25.0 + (1e3 * radius * 0.1).powi(2)).sqrt();
    assert!(
        (scores.wmse_mm.expect("rows") - expected).abs() < 1e-2,
        "{scores:?}, not {expected}"
    );
    assert!(
        (scores.final_error_mm.expect("a last row") - 5.0).abs() < 1e-2,
        "{scores:?}"
    );
    assert_eq!(scores.wmse_occluded_mm, None);
}
