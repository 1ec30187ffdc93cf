//! The pusher's force on a disc that it pushes straight over a table: in closed form its size is
//! μ_s m g while the disc slides, and 0 before.

use stickslip::diagnosis::{Finding, Severity, Subject, diagnose};
use stickslip::dynamics::Pose;
use stickslip::{Estimate, ForceSensor, Log, RunOptions, Setup, run};

use crate::common;

/// Speed of the pusher (m/s), and the time at which it reaches the disc (s).
const SPEED: f64 = 0.02;
const CONTACT: f64 = 0.75;

/// True friction, in place of the scene's 0.31.
const MU_S: f64 = 0.22;

fn sensor() -> ForceSensor {
    ForceSensor {
        force_std: 0.02,
        bias_std: 0.1,
        scale_std: 0.1,
    }
}

fn setup() -> Setup {
    Setup {
        wrench: Some(sensor()),
        ..common::setup(&[])
    }
}

/// The push, whose sensor reads `bias` (N) too much along x, and `factor` times the force.
fn log(setup: &Setup, bias: f64, factor: f64) -> Log {
    let pushed = |time: f64| (SPEED * (time - CONTACT)).max(0.0);
    // no frame equals the one before
    let object = |time: f64| Some(Pose::new(pushed(time) + 1e-9 * time, 0.0, 0.0));
    let pusher = |time: f64| Some(Pose::new(-0.035 + SPEED * (time - CONTACT), 0.0, 0.0));
    let mut log = common::log(75, object, pusher);
    let sliding = MU_S * setup.scene.object.mass * setup.scene.gravity;
    let force = |time: &f64| {
        let force = if *time > CONTACT { sliding } else { 0.0 };
        Some([factor * force + bias, 0.0])
    };
    log.force = log.time.iter().map(force).collect();
    log
}

fn estimate(setup: &Setup, log: &Log) -> Estimate {
    let options = RunOptions {
        seed: 3,
        ..RunOptions::default()
    };
    let run = run(setup, log, &options, &mut |_| ()).expect("a run");
    run.estimate
}

/// Estimated μ_s at the last row and its standard deviation.
fn mu_s(setup: &Setup, log: &Log) -> (f64, f64) {
    let estimate = estimate(setup, log);
    let last = estimate.rows.last().expect("rows");
    let spread = last.spread.and_then(|spread| spread.friction);
    let friction = last.friction.expect("an estimate");
    (friction.mu_s, spread.expect("a spread").mu_s)
}

#[test]
fn the_force_shows_the_tables_friction() {
    let setup = setup();
    let log = log(&setup, 0.0, 1.0);
    let (found, std) = mu_s(&setup, &log);
    assert!((found / MU_S - 1.0).abs() < 0.1, "{found}");
    assert!(std / found < 0.2, "{found} ± {std}");

    let without = Setup {
        wrench: None,
        ..setup
    };
    let (found, std) = mu_s(&without, &log);
    assert!(found > 0.26 && std / found > 0.25, "{found} ± {std}");
}

/// The free way before the contact shows the bias.
#[test]
fn a_bias_does_not_count_as_friction() {
    let mut setup = setup();
    let log = log(&setup, 0.3, 1.0);
    setup.wrench = Some(ForceSensor {
        bias_std: 0.3,
        ..sensor()
    });
    let (found, _) = mu_s(&setup, &log);
    assert!((found / MU_S - 1.0).abs() < 0.12, "{found}");

    // as if it were tared
    setup.wrench = Some(ForceSensor {
        bias_std: 0.0,
        ..sensor()
    });
    let (found, _) = mu_s(&setup, &log);
    assert!(found / MU_S > 1.15, "{found}");
}

#[test]
fn one_wrong_force_changes_little() {
    let setup = setup();
    let mut log = log(&setup, 0.0, 1.0);
    log.force[60] = Some([8.0, -5.0]);
    let (found, _) = mu_s(&setup, &log);
    assert!((found / MU_S - 1.0).abs() < 0.1, "{found}");
}

fn force(setup: &Setup, log: &Log) -> Vec<Finding> {
    let mut findings = diagnose(setup, log);
    findings.retain(|finding| finding.subject == Subject::Force);
    findings
}

#[test]
fn check_tells_what_is_wrong_with_a_force() {
    let setup = setup();
    let of = |bias, factor| force(&setup, &log(&setup, bias, factor));
    let [fine] = &of(0.0, 1.0)[..] else {
        panic!("one finding")
    };
    assert_eq!(fine.severity, Severity::Ok);
    assert!(fine.found.contains("0.22"), "{fine}");

    let [negated] = &of(0.0, -1.0)[..] else {
        panic!("one finding")
    };
    assert_eq!(negated.severity, Severity::Problem);
    assert!(negated.to_string().contains("change its sign"), "{negated}");

    let findings = of(0.9, 1.0);
    assert!(findings[0].to_string().contains("tare"), "{findings:?}");

    let findings = of(0.0, 10.0);
    let [grams] = &findings[..] else {
        panic!("one finding")
    };
    assert_eq!(grams.severity, Severity::Warning);
    assert!(grams.found.contains("2.20"), "{grams}");
}

#[test]
fn check_says_that_forces_are_not_used() {
    let setup = setup();
    let log = log(&setup, 0.0, 1.0);
    let without = Setup {
        wrench: None,
        ..setup
    };
    let findings = force(&without, &log);
    assert_eq!(findings.len(), 1);
    assert!(findings[0].found.contains("[wrench]"), "{findings:?}");
}
