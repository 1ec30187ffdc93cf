//! The particle filter against the exact Kalman filter on a linear-Gaussian model.
//!
//! Compared are the means and variances from the sums that every step takes.
//!
//! Each comparison is of an average over `SEEDS` independent filters with the exact value, in units
//! of the average's own standard error. Under the exact algorithm such a z is nearly standard
//! normal, so |z| < 4.5 over some hundred comparisons; the standard errors are themselves asserted
//! to be small, so that the test can fail. A filter of N particles is biased by O(1/N), well below
//! the standard error here.

use crate::common::{AXIS, Axis, POSITION, Sums, VELOCITY, series, settings};
use stickslip_filter::{ParticleFilter, Resampling, Settings, WeightUpdate};

const SEEDS: u64 = 40;
const PARTICLES: usize = 2000;
const ROWS: usize = 20;

#[derive(Clone, Copy, Default)]
struct Row {
    position: f64,
    velocity: f64,
    position_variance: f64,
    velocity_variance: f64,
}

struct Run {
    rows: Vec<Row>,
    log_evidence: f64,
    resampled: usize,
}

/// A filter of as many particles at each row as `sizes` has in turn.
fn run(resampling: Resampling, seed: u64, sizes: &[usize]) -> Run {
    let (times, measurements) = series(ROWS, 1);
    let settings = Settings {
        resampling,
        ..settings(sizes[0], seed)
    };
    let mut filter = ParticleFilter::new(Axis::OPEN, settings).unwrap();
    filter.recompute_sums(&0.0);
    let mut run = Run {
        rows: vec![moments(filter.sums())],
        log_evidence: 0.0,
        resampled: 0,
    };
    for row in 1..ROWS {
        let size = sizes[row % sizes.len()];
        let resized = size != filter.settings().particles;
        filter.resize(size).unwrap();
        let report = filter.step(&(times[row] - times[row - 1]), measurements[row].as_ref());
        if let WeightUpdate::Weighed { log_evidence } = report.weight_update {
            run.log_evidence += log_evidence;
        }
        run.resampled += usize::from(report.resampled || resized);
        run.rows.push(moments(filter.sums()));
    }
    run
}

fn moments(sums: &Sums) -> Row {
    Row {
        position: sums.first[POSITION],
        velocity: sums.first[VELOCITY],
        position_variance: sums.variance(POSITION),
        velocity_variance: sums.variance(VELOCITY),
    }
}

/// (mean, standard error of the mean).
fn mean_and_error(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn check(what: &str, estimates: &[f64], exact: f64, scale: f64) {
    let (mean, error) = mean_and_error(estimates);
    assert!(
        error < 0.03 * scale,
        "{what}: standard error {error} is too large to test anything"
    );
    assert!(
        (mean - exact).abs() < 4.5 * error,
        "{what}: {mean} +- {error}, exactly {exact}"
    );
}

fn agrees_with_kalman(resampling: Resampling, sizes: &[usize]) {
    let (times, measurements) = series(ROWS, 1);
    let exact = AXIS.filter(&times, &measurements).unwrap();
    let runs: Vec<Run> = (0..SEEDS)
        .map(|seed| run(resampling, seed, sizes))
        .collect();
    assert!(
        runs.iter().all(|run| run.resampled >= 3),
        "resampling takes part"
    );
    for (row, exact) in exact.rows.iter().enumerate() {
        let exact = exact.unwrap();
        let all =
            |f: fn(&Row) -> f64| -> Vec<f64> { runs.iter().map(|run| f(&run.rows[row])).collect() };
        let (x, v) = (exact.position_variance, exact.velocity_variance);
        check(
            &format!("row {row} position"),
            &all(|r| r.position),
            exact.position,
            x.sqrt(),
        );
        check(
            &format!("row {row} velocity"),
            &all(|r| r.velocity),
            exact.velocity,
            v.sqrt(),
        );
        check(
            &format!("row {row} position variance"),
            &all(|r| r.position_variance),
            x,
            x,
        );
        check(
            &format!("row {row} velocity variance"),
            &all(|r| r.velocity_variance),
            v,
            v,
        );
    }

    // the estimate of the evidence itself (not of its logarithm) is unbiased (Del Moral 2004,
    // theorem 7.4.2)
    let ratios: Vec<f64> = runs
        .iter()
        .map(|run| libm::exp(run.log_evidence - exact.log_likelihood))
        .collect();
    check("evidence / exact evidence", &ratios, 1.0, 1.0);
}

#[test]
fn filter_with_systematic_resampling_agrees_with_kalman() {
    agrees_with_kalman(Resampling::Systematic, &[PARTICLES]);
}

#[test]
fn filter_with_stratified_resampling_agrees_with_kalman() {
    agrees_with_kalman(Resampling::Stratified, &[PARTICLES]);
}

#[test]
fn filter_with_residual_resampling_agrees_with_kalman() {
    agrees_with_kalman(Resampling::Residual, &[PARTICLES]);
}

#[test]
fn filter_with_multinomial_resampling_agrees_with_kalman() {
    agrees_with_kalman(Resampling::Multinomial, &[PARTICLES]);
}

#[test]
fn filter_whose_number_of_particles_changes_agrees_with_kalman() {
    agrees_with_kalman(
        Resampling::Systematic,
        &[PARTICLES, PARTICLES, 1500, 1500, 2500, 1980],
    );
}
