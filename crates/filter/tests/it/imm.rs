//! The interacting multiple model filter against exact answers: a single filter, weights from whole
//! likelihoods where modes do not change, and the sum over all histories of modes where they do.

use crate::common::{AXIS, series};
use stickslip_filter::{
    AxisEstimate, ConstantVelocity, Gaussian, InteractingMultipleModel, Purpose, SeriesError,
    Streams,
};

fn mode(process_noise: f64) -> ConstantVelocity {
    ConstantVelocity {
        process_noise,
        ..AXIS
    }
}

fn imm(mean_sojourn_time: f64) -> InteractingMultipleModel<3> {
    InteractingMultipleModel {
        modes: [0.005, 0.5, 5.0].map(mode),
        mean_sojourn_time,
    }
}

/// Mean and variances of a mixture of normal distributions.
fn mixture(parts: &[(f64, AxisEstimate)]) -> AxisEstimate {
    let total: f64 = parts.iter().map(|(w, _)| w).sum();
    let mean =
        |of: fn(&AxisEstimate) -> f64| parts.iter().map(|(w, e)| w * of(e)).sum::<f64>() / total;
    let (position, velocity) = (mean(|e| e.position), mean(|e| e.velocity));
    let variance = |part: &dyn Fn(&AxisEstimate) -> f64| {
        parts.iter().map(|(w, e)| w * part(e)).sum::<f64>() / total
    };
    AxisEstimate {
        position,
        velocity,
        position_variance: variance(&|e| e.position_variance + (e.position - position).powi(2)),
        velocity_variance: variance(&|e| e.velocity_variance + (e.velocity - velocity).powi(2)),
        covariance: variance(&|e| e.covariance + (e.position - position) * (e.velocity - velocity)),
    }
}

/// Largest difference: means in standard deviations, variances relative.
fn distance(got: AxisEstimate, exact: AxisEstimate) -> f64 {
    let mean = |a: f64, b: f64, variance: f64| (a - b).abs() / variance.sqrt();
    let relative = |a: f64, b: f64| (a / b - 1.0).abs();
    let scale = exact.position_variance * exact.velocity_variance;
    mean(got.position, exact.position, exact.position_variance)
        .max(mean(got.velocity, exact.velocity, exact.velocity_variance))
        .max(relative(got.position_variance, exact.position_variance))
        .max(relative(got.velocity_variance, exact.velocity_variance))
        .max((got.covariance - exact.covariance).abs() / scale.sqrt())
}

#[test]
fn filter_with_one_mode_is_its_kalman_filter() {
    let (times, measurements) = series(60, 4);
    for mean_sojourn_time in [0.1, f64::INFINITY] {
        let got = InteractingMultipleModel {
            modes: [AXIS],
            mean_sojourn_time,
        }
        .filter(&times, &measurements)
        .unwrap();
        let exact = AXIS.filter(&times, &measurements).unwrap();
        assert!(
            (got.log_likelihood - exact.log_likelihood).abs() < 1e-9 * exact.log_likelihood.abs()
        );
        for (got, exact) in got.rows.iter().zip(&exact.rows) {
            assert!(distance(got.unwrap(), exact.unwrap()) < 1e-9);
        }
    }
}

/// One unknown mode for good: each filter's weight is the likelihood of all rows so far.
#[test]
fn filter_whose_modes_last_is_the_average_over_them_by_likelihood() {
    let (times, measurements) = series(40, 3);
    let imm = imm(f64::INFINITY);
    let got = imm.filter(&times, &measurements).unwrap();
    for row in 0..times.len() {
        let part = |mode: &ConstantVelocity| {
            let so_far = mode.filter(&times[..=row], &measurements[..=row]).unwrap();
            (libm::exp(so_far.log_likelihood), so_far.rows[row].unwrap())
        };
        let parts: Vec<(f64, AxisEstimate)> = imm.modes.iter().map(part).collect();
        assert!(
            distance(got.rows[row].unwrap(), mixture(&parts)) < 1e-9,
            "row {row}"
        );
        if row + 1 == times.len() {
            let evidence = libm::log(parts.iter().map(|(w, _)| w / 3.0).sum());
            assert!((got.log_likelihood - evidence).abs() < 1e-9 * evidence.abs());
        }
    }
}

/// Exact by brute force: every history of modes with its own Kalman filter, 3⁷ of them.
fn all_histories(
    imm: &InteractingMultipleModel<3>,
    times: &[f64],
    measurements: &[Option<f64>],
) -> (AxisEstimate, f64) {
    let start = |mode: &ConstantVelocity| mode.start(measurements[0].unwrap());
    let mut histories: Vec<(f64, usize, Gaussian<2>)> = imm
        .modes
        .iter()
        .enumerate()
        .map(|(j, mode)| (1.0 / 3.0, j, start(mode)))
        .collect();
    for row in 1..times.len() {
        let h = times[row] - times[row - 1];
        let stay = libm::exp(-h / imm.mean_sojourn_time);
        let next = |&(weight, from, state): &(f64, usize, Gaussian<2>)| {
            imm.modes.iter().enumerate().map(move |(to, mode)| {
                let change = if to == from { stay } else { (1.0 - stay) / 2.0 };
                let predicted = mode.predict(&state, h);
                let (state, log_likelihood) =
                    measurements[row].map_or((predicted, 0.0), |z| mode.update(&predicted, z));
                (weight * change * libm::exp(log_likelihood), to, state)
            })
        };
        histories = histories.iter().flat_map(next).collect();
    }
    let parts: Vec<(f64, AxisEstimate)> = histories
        .iter()
        .map(|(w, _, state)| (*w, AxisEstimate::from(*state)))
        .collect();
    (
        mixture(&parts),
        libm::log(parts.iter().map(|(w, _)| w).sum()),
    )
}

/// As long as no mode starts a row with a measurement from a true mixture, moments are all that
/// count, and they are exact.
#[test]
fn filter_is_the_sum_over_all_histories_of_modes_until_a_second_measurement_follows_a_change() {
    let imm = imm(2.0);
    for seed in 0..20 {
        let (times, mut measurements) = series(7, seed);
        measurements[2..].fill(None);
        let got = imm.filter(&times, &measurements).unwrap();
        let (exact, evidence) = all_histories(&imm, &times, &measurements);
        assert!(distance(got.rows[6].unwrap(), exact) < 1e-9, "seed {seed}");
        assert!((got.log_likelihood - evidence).abs() < 1e-9, "seed {seed}");
    }
}

/// After that a mixture counts as the normal distribution of its moments: near the exact answer,
/// not on it.
#[test]
fn filter_is_near_the_sum_over_all_histories_of_modes() {
    let imm = imm(2.0);
    let mut sums = [0.0; 3];
    for seed in 0..50 {
        let (times, measurements) = series(7, seed);
        let got = imm.filter(&times, &measurements).unwrap();
        let (exact, evidence) = all_histories(&imm, &times, &measurements);
        let single = AXIS.filter(&times, &measurements).unwrap().rows[6].unwrap();
        sums[0] += distance(got.rows[6].unwrap(), exact);
        sums[1] += (got.log_likelihood - evidence).abs();
        sums[2] += distance(single, exact);
    }
    let [error, evidence, single] = sums.map(|sum| sum / 50.0);
    assert!(
        error < 0.1 && evidence < 0.1,
        "{error} standard deviations, {evidence} in the evidence"
    );
    assert!(
        single > 3.0 * error,
        "the middle mode alone is {single} off, all together {error}"
    );
}

/// The axis rests, moves and stops: no single process noise fits all of it as well as the modes
/// together, although the filter learns the mode on the way.
#[test]
fn filter_predicts_a_start_and_a_stop_better_than_any_of_its_modes() {
    let draw = Streams::new(1).of(Purpose::Measure);
    let times: Vec<f64> = (0..360).map(|row| f64::from(row) / 30.0).collect();
    let noise = |row: usize| AXIS.measurement_std * draw.at(row as u64).normal(0, 0);
    let measurements: Vec<Option<f64>> = times
        .iter()
        .enumerate()
        .map(|(row, t)| Some(20.0 * (t.clamp(4.0, 6.0) - 4.0) + noise(row)))
        .collect();
    let imm = InteractingMultipleModel {
        modes: [1e-5, 0.5, 1e3].map(mode),
        mean_sojourn_time: 30.0,
    };
    let together = imm.filter(&times, &measurements).unwrap().log_likelihood;
    let best = AXIS.fit_process_noise(&times, &measurements).unwrap();
    assert!(
        together > best.log_likelihood + 10.0,
        "{together}, the best single one with hindsight {}",
        best.log_likelihood
    );
}

#[test]
fn filter_row_is_a_function_of_the_rows_up_to_it() {
    let (times, measurements) = series(50, 5);
    let all = imm(3.0).filter(&times, &measurements).unwrap().rows;
    for row in 0..times.len() {
        assert_eq!(
            imm(3.0)
                .filter(&times[..=row], &measurements[..=row])
                .unwrap()
                .rows,
            all[..=row]
        );
    }
}

#[test]
fn model_out_of_range_is_refused() {
    fn refuse<const M: usize>(imm: InteractingMultipleModel<M>) -> String {
        imm.filter(&[], &[]).unwrap_err().to_string()
    }
    assert_eq!(
        refuse(InteractingMultipleModel {
            modes: [],
            mean_sojourn_time: 1.0
        }),
        "`modes` is 0; it must be finite and at least 1"
    );
    for mean_sojourn_time in [0.0, -1.0, f64::NAN] {
        assert!(refuse(imm(mean_sojourn_time)).starts_with("`mean_sojourn_time` is "));
    }
    assert!(
        refuse(InteractingMultipleModel {
            modes: [mode(-1.0)],
            mean_sojourn_time: 1.0
        })
        .starts_with("`process_noise` is -1")
    );
    let series = imm(1.0).filter(&[0.0, 0.0], &[None, None]).unwrap_err();
    assert!(matches!(series, SeriesError::Time { row: 1, .. }));
}
