//! References that an experiment is scored against, by motions that are known in closed form.

use stickslip::dynamics::Pose;
use stickslip::{Estimate, EstimateRow, Log, Setup};
use stickslip_evaluation::{Reference, score};
use stickslip_formats::{Experiment, Truth, TruthFacts, read_scene};

fn setup() -> Setup {
    read_scene(
        include_str!("../../formats/tests/it/full_scene.toml"),
        "scene.toml",
    )
    .expect("a scene")
}

/// Its camera shows everything later (s).
fn setup_with_latency(latency: f64) -> Setup {
    let mut setup = setup();
    let camera = setup.camera.as_mut().expect("the scene has a camera");
    camera.latency = latency;
    setup
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
    let latency = 0.16;
    let setup = setup_with_latency(latency);
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

/// A camera that is 0.16 s late shows at row k where the object was then: the present is between
/// two later rows, and beyond the last one it is not known.
#[test]
fn pose_at_a_time_is_that_of_the_rows_that_show_it() {
    let latency = 0.16;
    let setup = setup_with_latency(latency);
    let mut log = log(31);
    for (time, pose) in log.time.iter().zip(&mut log.object) {
        *pose = Some(moving(time - latency));
    }
    log.object[20] = None;
    let time = log.time.clone();
    let experiment =
        Experiment::new(setup, log, None, TruthFacts::default()).expect("an experiment");
    let reference = Reference::of(&experiment);
    for row in [0, 7, 25] {
        let pose = reference.pose_at(time[row]).expect("shown later");
        assert_near(pose, moving(time[row]));
    }
    let lost = reference.pose_at(time[20] - latency + 0.01);
    assert_eq!((lost, reference.pose_at(time[28])), (None, None));
}

/// Without truth the last pose is off by 5 mm and the second before it by 0.1 mm on the mean.
#[test]
fn final_error_without_truth_is_the_mean_of_the_last_second() {
    let mut log = log(91);
    let off = |row: usize| match row {
        90 => 5e-3,
        row if row % 2 == 0 => 1e-3,
        _ => -1e-3,
    };
    for (row, pose) in log.object.iter_mut().enumerate() {
        *pose = Some(Pose::new(off(row), 0.0, off(row)));
    }
    let rest = EstimateRow {
        pose: Some(Pose::default()),
        ..EstimateRow::default()
    };
    let estimate = Estimate {
        time: log.time.clone(),
        rows: vec![rest; 91],
        ..Estimate::default()
    };
    let experiment =
        Experiment::new(setup(), log, None, TruthFacts::default()).expect("an experiment");
    let scores = score(&estimate, &Reference::of(&experiment), &[false; 91], 0.02);
    // rows 60 to 90: fifteen pairs that cancel, and the last one
    let expected = 5.0 / 31.0;
    let found = scores.final_error_mm.expect("a last row");
    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    let turn = scores.final_error_deg.expect("a last row");
    assert!(
        (turn - (expected * 1e-3).to_degrees()).abs() < 1e-9,
        "{turn}"
    );
}
