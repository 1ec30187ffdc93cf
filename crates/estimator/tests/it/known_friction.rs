//! Friction of an estimate.

use crate::common::{log, setup};
use stickslip::dynamics::{Friction, Pose};
use stickslip::{EstimateRow, FilterModel, Log, Occlusion, RunOptions, Setup, Uncertainty, run};

/// A pusher that drives the disc of [`setup`] off its middle, so that it turns; the disc is not
/// shown to turn, which some friction explains better than other.
fn pushed() -> Log {
    let at = |time: f64| 0.02 * (time - 1.0);
    log(
        120,
        |time| Some(Pose::new(at(time).max(0.0), 0.0, 0.0)),
        |time| Some(Pose::new(-0.034 + at(time), 0.006, 0.0)),
    )
}

fn rows(setup: &Setup, log: &Log, occlusion: Occlusion, model: FilterModel) -> Vec<EstimateRow> {
    let options = RunOptions {
        model,
        particles: 200,
        occlusion,
        ..RunOptions::default()
    };
    let run = run(setup, log, &options, &mut |_| ()).expect("a run");
    run.estimate.rows
}

/// Means and standard deviations.
fn known(row: &EstimateRow) -> (Friction, Friction) {
    let std = row.spread.and_then(|spread| spread.friction);
    (row.friction.expect("friction"), std.expect("its spread"))
}

#[test]
fn the_last_blackout_changes_nothing_that_was_known_before() {
    // after the last pose nothing is learned, and nothing else depends on that
    let (setup, log) = (setup(&[]), pushed());
    let ends = Occlusion::Rows { from: 50, to: None };
    let returns = Occlusion::Rows {
        from: 50,
        to: Some(119),
    };
    let ends = rows(&setup, &log, ends, FilterModel::Robust);
    let returns = rows(&setup, &log, returns, FilterModel::Robust);
    assert_eq!(ends[..50], returns[..50]);
    for row in 50..119 {
        assert_eq!(ends[row].pose, returns[row].pose, "row {row}");
        assert_eq!(known(&ends[row]), known(&returns[row]), "row {row}");
    }
}

#[test]
fn friction_that_is_told_exactly_is_not_learned() {
    let mut setup = setup(&[]);
    setup.uncertainty = Uncertainty {
        friction: Friction::default(),
        ..setup.uncertainty
    };
    let rows = rows(&setup, &pushed(), Occlusion::None, FilterModel::Robust);
    let (mean, std) = known(rows.last().expect("rows"));
    for (mean, told) in mean.fields().iter().zip(setup.scene.nominal.fields()) {
        assert!((*mean - told).abs() < 1e-12, "{mean}, {told}");
    }
    assert!(std.fields().iter().all(|std| **std < 1e-7), "{std:?}");
}
