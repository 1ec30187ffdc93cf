//! A [`Tracker`] gives, row by row, what a run over the whole log gives, and takes rows as they
//! come.

use std::num::NonZero;

use crate::common::{log, setup};
use stickslip::dynamics::Pose;
use stickslip::{
    Camera, Estimate, ForceSensor, Log, Row, RowError, RunOptions, Setup, Tracker, TrackerOptions,
    Tracking, run,
};

/// A push into a fixel with gaps: object poses missing, the pusher lost for short and for long,
/// forces missing.
fn push() -> (Setup, Log) {
    let mut setup = setup(&[[0.075, 0.01]]);
    setup.wrench = Some(ForceSensor {
        force_std: 0.03,
        bias_std: 0.1,
        scale_std: 0.1,
    });
    let lost = |t: f64, from: f64, to: f64| (from..to).contains(&t);
    let object = |t: f64| {
        (t > 0.1 && !lost(t, 1.0, 1.6)).then(|| Pose::new(0.02 * (t - 0.4).max(0.0), 0.0, 0.0))
    };
    let pusher = |t: f64| {
        (!lost(t, 0.7, 0.8) && !lost(t, 2.0, 2.5)).then(|| Pose::new(-0.043 + 0.02 * t, 0.001, 0.0))
    };
    let mut log = log(90, object, pusher);
    let reading = |row: usize| (!row.is_multiple_of(7)).then_some(row > 60);
    log.tactile = vec![(0..90).map(reading).collect()];
    let force =
        |row: usize| (!row.is_multiple_of(5)).then_some([if row > 12 { 1.4 } else { 0.05 }, 0.1]);
    log.force = (0..90).map(force).collect();
    (setup, log)
}

fn with_latency(setup: Setup, latency: f64) -> Setup {
    let camera = setup.camera.map(|camera| Camera { latency, ..camera });
    Setup { camera, ..setup }
}

fn tracked(setup: &Setup, log: &Log, options: &TrackerOptions) -> Estimate {
    let mut tracker = Tracker::new(setup, options).expect("a tracker");
    let rows = (0..log.len()).map(|row| tracker.push(&log.row(row)).expect("an estimate").clone());
    Estimate {
        rows: rows.collect(),
        time: log.time.clone(),
        others: 1,
        has_tripod: true,
    }
}

#[test]
fn rows_one_by_one_give_what_the_whole_log_gives_causally() {
    for latency in [0.0, 0.05, 0.4] {
        let (setup, log) = push();
        let setup = with_latency(setup, latency);
        let options = RunOptions {
            particles: 100,
            tracking: Tracking::Causal,
            ..RunOptions::default()
        };
        let whole = run(&setup, &log, &options, &mut |_| ()).expect("a run");
        let options = TrackerOptions {
            particles: 100,
            ..TrackerOptions::default()
        };
        assert_eq!(
            tracked(&setup, &log, &options),
            whole.estimate,
            "latency {latency} s"
        );
    }
}

/// Later rows cannot change what was said: the estimate of a log that is cut off is the beginning
/// of the whole one's.
#[test]
fn an_estimate_depends_on_no_later_row() {
    let (setup, log) = push();
    let options = TrackerOptions {
        particles: 50,
        ..TrackerOptions::default()
    };
    let whole = tracked(&setup, &log, &options);
    let mut changed = log.clone();
    for row in 50..90 {
        changed.pusher[row] = None;
        changed.object[row] = Some(Pose::new(0.5, 0.5, 1.0));
    }
    assert_eq!(
        tracked(&setup, &changed, &options).rows[..50],
        whole.rows[..50]
    );
}

#[test]
fn after_warm_up_a_row_allocates_nothing_on_one_thread() {
    let (setup, log) = push();
    let mut setup = with_latency(setup, 0.05);
    // by default, a few steps of this log need the mode search, which allocates
    setup.uncertainty.pusher_lag = 1.0;
    // and under feet that are stretched far, a buffer grows in one of these rows
    setup.uncertainty.foot_stretch = 0.1;
    // the pusher pushes; once the object comes to a fixel, some steps need it, too
    let rows: Vec<Row> = (0..76).map(|row| log.row(row)).collect();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool");
    pool.install(|| {
        let mut tracker = Tracker::new(&setup, &TrackerOptions::default()).expect("a tracker");
        rows[..60].iter().for_each(|row| {
            tracker.push(row).expect("an estimate");
        });
        let info = allocation_counter::measure(|| {
            rows[60..].iter().for_each(|row| {
                tracker.push(row).expect("an estimate");
            });
        });
        assert_eq!(info.count_total, 0, "{info:?}");
    });
}

/// The camera stands still over an object at rest: each of its poses says the same, on time or
/// late.
fn at_rest(late: &[f64]) -> Tracker<'static> {
    let mut setup = setup(&[]);
    // a camera of nominal noise, so that all is normal
    setup.uncertainty.camera_noise = 0.0;
    let mut tracker = Tracker::new(&setup, &TrackerOptions::default()).expect("a tracker");
    let away = Some(Pose::new(-0.1, 0.0, 0.0));
    for row in 0..10 {
        let object = (row == 0).then(Pose::default);
        let (time, pusher) = (f64::from(row) / 30.0, away);
        let row = Row {
            time,
            object,
            pusher,
            ..Row::default()
        };
        tracker.push(&row).expect("an estimate");
    }
    for time in late {
        let object = Some(Pose::new(2e-4, 0.0, 0.0));
        let row = Row {
            time: *time,
            object,
            ..Row::default()
        };
        tracker.push(&row).expect("an estimate");
    }
    tracker
}

/// The posterior of a constant from a prior and measurements of it, all normal; the filter widens
/// the camera's standard deviations by `likelihood_scale`, 1.5.
#[test]
fn late_poses_are_weighed_as_if_the_object_had_been_seen_then() {
    let spread = |tracker: &Tracker<'_>| tracker.estimate().spread.expect("a spread").pose.x;
    let mean = |tracker: &Tracker<'_>| tracker.estimate().pose.expect("a pose").x;
    let none = at_rest(&[]);
    let late = at_rest(&[0.25, 0.20]);
    let (prior, noise) = (spread(&none).powi(-2), (1.5f64 * 3e-4).powi(-2));
    let precision = prior + 2.0 * noise;
    let exact = (prior * mean(&none) + 2.0 * noise * 2e-4) / precision;
    // 500 particles: a twentieth of the standard deviation, three times over
    let error = 3.0 * spread(&none) / 500f64.sqrt();
    assert!(
        (mean(&late) - exact).abs() < error,
        "{} {exact}",
        mean(&late)
    );
    let ratio = spread(&late) * precision.sqrt();
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
    assert_eq!(none.time(), late.time());
}

/// A late pose is compared with where a particle was, not with where it is, while the object moves.
#[test]
fn a_late_pose_of_a_moving_object_does_not_pull_it_back() {
    let (setup, log) = push();
    let options = TrackerOptions::default();
    let mut tracker = Tracker::new(&setup, &options).expect("a tracker");
    for row in 0..54 {
        tracker.push(&log.row(row)).expect("an estimate");
    }
    let before = tracker.estimate().pose.expect("a pose");
    // where the camera saw it 4 rows, some 2.7 mm, earlier
    let then = log.row(49);
    let row = Row {
        object: log.object[49],
        time: then.time,
        ..Row::default()
    };
    let after = tracker
        .push(&row)
        .expect("an estimate")
        .pose
        .expect("a pose");
    assert!((after.x - before.x).abs() < 5e-4, "{before:?} {after:?}");
}

#[test]
fn rows_that_cannot_be_used_are_refused_and_change_nothing() {
    let mut tracker = at_rest(&[]);
    let before = tracker.estimate().clone();
    let at = |time: f64| Row {
        time,
        ..Row::default()
    };
    let pose = |x: f64| Some(Pose::new(x, 0.0, 0.0));
    let cases: [(Row, &str); 6] = [
        (at(f64::NAN), "the row's time is NaN s"),
        (
            Row {
                object: pose(f64::INFINITY),
                ..at(0.4)
            },
            "the object's pose at 0.4 s is (inf, 0, 0)",
        ),
        (
            Row {
                pusher: pose(f64::NAN),
                ..at(0.4)
            },
            "the pusher's pose",
        ),
        (
            Row {
                tactile: vec![Some(true)],
                ..at(0.4)
            },
            "1 tactile reading but the scene has 0 fixels",
        ),
        (at(1000.0), "at most 5 s apart"),
        (at(0.05), "the tracker is at 0.3 s and remembers 0.2 s"),
    ];
    for (row, message) in cases {
        let error: RowError = tracker.push(&row).expect_err("a refusal");
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(*tracker.estimate(), before);
    }
    let next = Row {
        object: pose(0.0),
        ..at(0.34)
    };
    assert!(tracker.push(&next).is_ok());
}

#[test]
fn before_the_first_pose_there_is_no_estimate() {
    let mut tracker = Tracker::new(&setup(&[]), &TrackerOptions::default()).expect("a tracker");
    let row = Row {
        time: 0.0,
        pusher: Some(Pose::default()),
        ..Row::default()
    };
    let estimate = tracker.push(&row).expect("an empty row");
    assert_eq!((estimate.pose, estimate.visual), (None, false));
    assert!(tracker.particles().is_none());
}

/// Fewer particles and more again: the estimates stay near those of one number, and the same
/// numbers give the same bits.
#[test]
fn number_of_particles_may_change_from_row_to_row() {
    let (setup, log) = push();
    let tracked = |count: &dyn Fn(usize) -> u32| {
        let mut tracker = Tracker::new(&setup, &TrackerOptions::default()).expect("a tracker");
        let rows = (0..log.len()).map(|index| {
            let size = |_| NonZero::new(count(index)).expect("not 0");
            let estimate = tracker.push_sized(&log.row(index), size);
            let estimate = estimate.expect("an estimate").clone();
            let particles = tracker.particles().map_or(0, |particles| particles.len());
            (estimate, particles)
        });
        rows.collect::<Vec<_>>()
    };
    let changing = |row: usize| [500, 64, 130, 1000][row / 10 % 4];
    let (rows, steady) = (tracked(&changing), tracked(&|_| 500));
    assert_eq!(rows, tracked(&changing));
    // until the poses go on where the fixel stops the object
    let before = rows.iter().zip(&steady).enumerate().take(60);
    for (index, (row, steady)) in before.skip(10) {
        assert_eq!((row.1, steady.1), (changing(index) as usize, 500));
        let (found, expected) = (row.0.pose.expect("a pose"), steady.0.pose.expect("a pose"));
        let apart = (found.x - expected.x).hypot(found.y - expected.y);
        assert!(apart < 1e-3, "row {index}: {found:?}, {expected:?}");
    }
}
