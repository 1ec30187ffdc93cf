//! Random steps of the friction parameters in a row, and their limits: Table I of the paper, τ, and
//! the occlusion. Each test fails if two parameters are swapped.

use std::sync::Mutex;

use crate::common::{log, setup};
use stickslip::dynamics::{Friction, Pose};
use stickslip::{
    FilterModel, FilterSettings, Limits, Log, Observer, Occlusion, ParticleView, RunOptions, Setup,
    SolvedStep, run_observed,
};

/// The friction of every particle after every row.
#[derive(Debug, Default)]
struct FrictionRows(Mutex<Vec<Vec<Friction>>>);

impl Observer for FrictionRows {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, _: usize, particles: &ParticleView<'_>) {
        let row = (0..particles.len()).map(|i| particles.friction(i));
        self.0.lock().expect("one thread").push(row.collect());
    }
}

/// The friction of every particle, row by row; particles keep their places, since none is
/// resampled.
fn friction_rows(setup: &Setup, log: &Log, occlusion: Occlusion) -> Vec<Vec<Friction>> {
    let filter = FilterSettings {
        resample_below: 0.0,
        likelihood_scale: 1e6,
        ..setup.filter
    };
    let setup = Setup {
        filter,
        ..setup.clone()
    };
    let options = RunOptions {
        model: FilterModel::Paper,
        particles: 64,
        occlusion,
        ..RunOptions::default()
    };
    let rows = FrictionRows::default();
    run_observed(&setup, log, &options, &rows, &mut |_| ()).expect("a run");
    rows.0.into_inner().expect("one thread")
}

/// Share of the particles whose parameters changed between two rows, per parameter.
fn changed(before: &[Friction], after: &[Friction]) -> Friction {
    let share = |of: fn(&Friction) -> f64| {
        let pairs = before.iter().zip(after);
        pairs.filter(|(a, b)| of(a) != of(b)).count() as f64 / before.len() as f64
    };
    Friction {
        mu_s: share(|f| f.mu_s),
        mu_p: share(|f| f.mu_p),
        mu_f: share(|f| f.mu_f),
        d_tri: share(|f| f.d_tri),
    }
}

/// The parameters that change for nearly all particles; no parameter may change for some only.
fn moved(rows: &[Vec<Friction>], row: usize) -> Friction<bool> {
    changed(&rows[row - 1], &rows[row]).map(|share| {
        assert!(
            !(0.1..=0.9).contains(&share),
            "row {row}: {share} of the particles"
        );
        share > 0.5
    })
}

const NONE: Friction<bool> = Friction {
    mu_s: false,
    mu_p: false,
    mu_f: false,
    d_tri: false,
};

/// Pose at the origin, as the camera shows it.
fn at_origin(_: f64) -> Option<Pose> {
    Some(Pose::default())
}

#[test]
fn nothing_changes_where_nothing_touches_and_nothing_moves() {
    let log = log(10, at_origin, |_| Some(Pose::new(-0.1, 0.0, 0.0)));
    let rows = friction_rows(&setup(&[[0.1, 0.0]]), &log, Occlusion::None);
    assert_eq!(moved(&rows, 5), NONE);
}

#[test]
fn a_push_on_the_open_table_changes_all_but_mu_f() {
    let log = log(20, at_origin, |t| {
        Some(Pose::new(-0.036 + 0.03 * t, 0.002, 0.0))
    });
    let rows = friction_rows(&setup(&[[0.2, 0.0]]), &log, Occlusion::None);
    let expected = Friction {
        mu_f: false,
        ..NONE.map(|_| true)
    };
    assert_eq!(moved(&rows, 15), expected);
}

/// The pusher throws the object and is lifted; the object slides on into a fixel that it meets off
/// its centre, and along it.
#[test]
fn a_slide_along_a_fixel_without_the_pusher_changes_all_but_mu_p() {
    let slippery = |setup: Setup| {
        let mut setup = setup;
        setup.scene.nominal.mu_s = 0.05;
        setup.filter.limits.mu_s.min = 0.01;
        setup
    };
    let pusher = |t: f64| (t < 0.25).then(|| Pose::new(-0.036 + 0.5 * t, 0.0, 0.0));
    let log = log(20, at_origin, pusher);
    let rows = friction_rows(&slippery(setup(&[[0.155, -0.030]])), &log, Occlusion::None);
    let expected = Friction {
        mu_p: false,
        ..NONE.map(|_| true)
    };
    let found = (9..20).map(|row| changed(&rows[row - 1], &rows[row]));
    let at_fixel = found
        .filter(|share| share.mu_f > 0.3)
        .collect::<Vec<Friction>>();
    assert!(!at_fixel.is_empty(), "the object never met the fixel");
    for share in at_fixel {
        let some = share.map(|share| share > 0.0);
        assert_eq!(some, expected, "{share:?}");
    }
}

/// Pusher, object and fixel in one line: the pusher stalls, and nothing moves.
#[test]
fn a_jam_changes_only_the_frictions_of_the_contacts() {
    let log = log(20, at_origin, |t| {
        Some(Pose::new(-0.0352 + 0.001 * t, 0.0, 0.0))
    });
    let mut setup = setup(&[[0.0351, 0.0]]);
    setup.camera = setup.camera.map(|camera| stickslip::Camera {
        position_std: 1e-6,
        orientation_std: 1e-6,
        ..camera
    });
    setup.filter.force_std = 1e-6;
    let rows = friction_rows(&setup, &log, Occlusion::None);
    let share = changed(&rows[14], &rows[15]);
    assert!(share.mu_p > 0.9 && share.mu_f > 0.9, "{share:?}");
    assert_eq!((share.mu_s, share.d_tri), (0.0, 0.0));
}

/// Noise is wide: every parameter soon lies at both ends of its own interval, and never outside.
#[test]
fn each_parameter_stays_within_its_own_limits_and_reaches_them() {
    let limits = |min, max| Limits { min, max };
    let mut setup = setup(&[[0.0, 0.0351]]);
    setup.filter.parameter_std = 0.5;
    setup.filter.limits = Friction {
        mu_s: limits(0.30, 0.315),
        mu_p: limits(0.316, 0.325),
        mu_f: limits(0.326, 0.335),
        d_tri: limits(0.019, 0.021),
    };
    // along the fixel, pressed against it by a push from below
    let log = log(40, at_origin, |t| {
        Some(Pose::new(-0.030 + 0.02 * t, -0.0183 + 0.004 * t, 0.0))
    });
    let rows = friction_rows(&setup, &log, Occlusion::None);
    let all = rows.concat();
    let ends = |of: fn(&Friction) -> f64| {
        let fold = |pick: fn(f64, f64) -> f64, from| all.iter().map(of).fold(from, pick);
        limits(fold(f64::min, f64::INFINITY), fold(f64::max, 0.0))
    };
    let reached = Friction {
        mu_s: ends(|f| f.mu_s),
        mu_p: ends(|f| f.mu_p),
        mu_f: ends(|f| f.mu_f),
        d_tri: ends(|f| f.d_tri),
    };
    assert_eq!(reached, setup.filter.limits);
}

#[test]
fn no_parameter_changes_while_the_camera_is_dark() {
    let log = log(30, at_origin, |t| {
        Some(Pose::new(-0.036 + 0.03 * t, 0.002, 0.0))
    });
    let dark = Occlusion::Rows {
        from: 10,
        to: Some(20),
    };
    let rows = friction_rows(&setup(&[]), &log, dark);
    for row in 10..20 {
        assert_eq!(rows[row], rows[9], "row {row}");
    }
    assert!(moved(&rows, 9).mu_p && moved(&rows, 20).mu_p);
}

/// The pusher's rows come ten times as often as the camera's: no row between two frames is
/// occluded.
#[test]
fn parameters_change_between_frames_of_a_camera_that_is_slower_than_the_rows() {
    let last = 150;
    let time: Vec<f64> = (0..200).map(|row| f64::from(row) / 300.0).collect();
    let pose = |row: usize| (row.is_multiple_of(10) && row <= last).then(Pose::default);
    let log = Log {
        object: (0..200).map(pose).collect(),
        pusher: time
            .iter()
            .map(|t| Some(Pose::new(-0.036 + 0.03 * t, 0.002, 0.0)))
            .collect(),
        time,
        ..Log::default()
    };
    let rows = friction_rows(&setup(&[]), &log, Occlusion::None);
    for row in [141, 145, 149, 150, 151, last + 24] {
        assert!(moved(&rows, row).mu_p, "row {row}");
    }
    for row in last + 27..200 {
        assert_eq!(rows[row], rows[last + 26], "row {row}");
    }
}
