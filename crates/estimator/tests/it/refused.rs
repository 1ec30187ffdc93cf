//! Impossible setups, logs or options are refused in words, whoever made them. Those at the edge of
//! what is possible run without a panic.

use crate::common::{log, setup};
use stickslip::dynamics::Pose;
use stickslip::{
    Camera, Log, PoseCovariance, RunOptions, Setup, Tracker, TrackerOptions, Tracking, run,
};

type Change<T> = fn(&mut T);

fn push() -> Log {
    let object = |t: f64| Some(Pose::new(0.02 * (t - 0.4).max(0.0), 0.0, 0.0));
    log(40, object, |t| {
        Some(Pose::new(-0.043 + 0.02 * t, 0.001, 0.0))
    })
}

fn camera(setup: &mut Setup) -> &mut Camera {
    setup.camera.as_mut().expect("the scene has a camera")
}

fn options(tracking: Tracking) -> RunOptions {
    RunOptions {
        particles: 20,
        tracking,
        ..RunOptions::default()
    }
}

/// Returns the refusal of a log, which both ways of tracking give.
#[track_caller]
fn refusal(setup: &Setup, log: &Log, options: &RunOptions) -> String {
    let refusal = |tracking| {
        let options = RunOptions {
            tracking,
            ..*options
        };
        let refused = run(setup, log, &options, &mut |_| ()).expect_err("a refusal");
        refused.to_string()
    };
    let smoothed = refusal(Tracking::Smoothed);
    assert_eq!(smoothed, refusal(Tracking::Causal));
    smoothed
}

#[test]
fn run_refuses_logs_that_cannot_be() {
    let cases: [(Change<Log>, &str); 11] = [
        (
            |log| log.object.truncate(39),
            "`object` has 39 entries and `time` 40",
        ),
        (
            |log| log.pusher.push(None),
            "`pusher` has 41 entries and `time` 40",
        ),
        (
            |log| log.tactile = vec![vec![None]],
            "`tactile 1` has 1 entries and `time` 40",
        ),
        (
            |log| log.force = vec![None],
            "`force` has 1 entries and `time` 40",
        ),
        (
            |log| log.time[3] = f64::NAN,
            "row 3: the row's time is NaN s",
        ),
        (
            |log| log.time[3] = log.time[2],
            "row 3 is at 0.06666666666666667 s and the row before it at 0.06666666666666667 s",
        ),
        (
            |log| log.time.iter_mut().for_each(|t| *t *= 1e3),
            "row 1 is at 33.333333333333336 s and the row before it at 0 s; rows must be at most 5 s apart; times seem to be in milliseconds. Give all times in seconds",
        ),
        (
            |log| log.pusher[5] = Some(Pose::new(f64::NAN, 0.0, 0.0)),
            "row 5: the pusher's pose at 0.16666666666666666 s is (NaN, 0, 0)",
        ),
        (
            |log| log.object_covariance = vec![Some(PoseCovariance::default()); log.len()],
            "row 0: the covariance of the object's pose at 0 s is PoseCovariance { x: 0.0,",
        ),
        (
            |log| log.object_covariance = vec![None],
            "object_covariance",
        ),
        (
            |log| log.pusher[5] = Some(Pose::new(1e30, 0.0, 0.0)),
            "is (1e30, 0.0, 0.0); no coordinate may be beyond 1e6 m",
        ),
    ];
    for (change, words) in cases {
        let mut log = push();
        change(&mut log);
        let text = refusal(&setup(&[[0.075, 0.01]]), &log, &options(Tracking::Smoothed));
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn run_and_tracker_refuse_setups_that_cannot_be() {
    let cases: [(Change<Setup>, &str); 12] = [
        (
            |s| s.scene.object.mass = 0.0,
            "scene.object.mass is 0.0 kg; it must be positive",
        ),
        (|s| s.scene.object.mass = 5e-324, "at least 1e-6 kg"),
        (|s| s.scene.object.mass = 1e30, "at most 1e6 kg"),
        (
            |s| s.scene.object.inertia = 1e308,
            "scene.object.inertia is 1e308 kg m^2; it must be at most 1e9 kg m^2",
        ),
        (|s| s.scene.object.inertia = 1e-30, "at least 1e-12 kg m^2"),
        (|s| s.scene.gravity = 1e300, "scene.gravity is 1e300 m/s^2"),
        (
            |s| s.scene.nominal.mu_p = f64::NAN,
            "scene.nominal.mu_p is NaN; it must be finite",
        ),
        (
            |s| s.scene.fixels[0].pose.x = f64::INFINITY,
            "the x of a fixel is inf m; it must be finite",
        ),
        (
            |s| camera(s).position_std = 0.0,
            "camera.position_std is 0.0 m; it must be positive",
        ),
        (
            |s| camera(s).pusher_position_std = 1.7e308,
            "camera.pusher_position_std",
        ),
        (
            |s| s.filter.force_std = 1e300,
            "filter.force_std is 1e300; it must be at most 1e6",
        ),
        (
            |s| s.filter.limits.mu_s.min = 2.0,
            "the width of filter.limits.mu_s is -1.0; it must be zero or positive",
        ),
    ];
    for (change, words) in cases {
        let mut setup = setup(&[[0.075, 0.01]]);
        change(&mut setup);
        let text = refusal(&setup, &push(), &options(Tracking::Smoothed));
        assert!(text.contains(words), "{text}");
        let tracker = Tracker::new(&setup, &TrackerOptions::default());
        assert_eq!(tracker.err().map(|error| error.to_string()), Some(text));
    }
}

#[test]
fn run_and_tracker_refuse_options_that_cannot_be() {
    let cases: [(Change<RunOptions>, &str); 4] = [
        (
            |o| o.substeps = Some(0),
            "0 substeps are asked for from row to row; it must be 1 to 10000",
        ),
        (|o| o.substeps = Some(u32::MAX), "4294967295 substeps"),
        (|o| o.particles = 0, "particle"),
        (
            |o| o.particles = usize::MAX / 4,
            "MB, which the system does not give; ask for fewer",
        ),
    ];
    for (change, words) in cases {
        let mut options = options(Tracking::Smoothed);
        change(&mut options);
        let text = refusal(&setup(&[]), &push(), &options);
        assert!(text.contains(words), "{text}");
    }
    for late in [f64::NAN, -1.0, f64::INFINITY] {
        let options = TrackerOptions {
            late,
            ..TrackerOptions::default()
        };
        let refused = Tracker::new(&setup(&[]), &options)
            .err()
            .expect("a refusal");
        assert!(refused.to_string().contains("from 0 to 5 s"), "{refused}");
    }
}

/// Setups and logs just within what is possible: estimates may be bad, but they come.
#[test]
fn run_takes_what_is_at_the_edge() {
    let setups: [Change<Setup>; 9] = [
        |s| s.scene.object.mass = 1e6,
        |s| s.scene.object.mass = 1e-6,
        |s| s.scene.object.inertia = 1e9,
        |s| s.scene.object.inertia = 1e-12,
        |s| s.scene.gravity = 1e5,
        |s| s.filter.force_std = 1e6,
        |s| camera(s).position_std = 1e6,
        |s| camera(s).pusher_position_std = 1e6,
        |s| s.scene.pusher.stall_force = Some(1e-9),
    ];
    let logs: [Change<Log>; 3] = [
        |log| log.pusher[5] = Some(Pose::new(1e6, 0.0, 0.0)),
        |log| log.object[5] = Some(Pose::new(0.0, -1e6, 1e6)),
        |log| log.time.iter_mut().for_each(|t| *t *= 1e-9),
    ];
    let same: Change<Setup> = |_| ();
    let plain: Change<Log> = |_| ();
    let cases = setups.map(|change| (change, plain)).into_iter();
    for (of_setup, of_log) in cases.chain(logs.map(|change| (same, change))) {
        let (mut setup, mut log) = (setup(&[[0.075, 0.01]]), push());
        of_setup(&mut setup);
        of_log(&mut log);
        for tracking in [Tracking::Smoothed, Tracking::Causal] {
            let result = run(&setup, &log, &options(tracking), &mut |_| ()).expect("a run");
            let poses = result.estimate.rows.iter().filter_map(|row| row.pose);
            assert!(poses.clone().count() == 40 && poses.clone().all(|pose| pose.is_finite()));
        }
    }
}
