//! Kalman filter and smoother against independent answers: one dense least-squares problem over all
//! rows, and the closed-form joint density of the measurements.

use crate::common::{AXIS, series};
use nalgebra::{
    DMatrix, DVector, Matrix2, RowVector2, SMatrix, SVector, Vector1, Vector2, Vector3,
};
use stickslip_filter::{
    AxisEstimate, ConstantVelocity, Gaussian, Optimum, Purpose, SeriesError, Streams,
};

/// All rows at once: minimises the sum of squared, whitened residuals of prior, transitions and
/// measurements by its normal equations; means and variances of every row.
fn batch(
    axis: &ConstantVelocity,
    times: &[f64],
    measurements: &[Option<f64>],
) -> Vec<AxisEstimate> {
    let n = times.len();
    let mut a = DMatrix::<f64>::zeros(2 * n, 2 * n);
    let mut b = DVector::<f64>::zeros(2 * n);
    a[(1, 1)] += 1.0 / axis.initial_velocity_std.powi(2);
    for (row, z) in measurements.iter().enumerate() {
        if let Some(z) = z {
            a[(2 * row, 2 * row)] += 1.0 / axis.measurement_std.powi(2);
            b[2 * row] += z / axis.measurement_std.powi(2);
        }
    }
    for row in 1..n {
        let h = times[row] - times[row - 1];
        let q = axis.process_noise;
        // inverse of q [h^3/3 h^2/2; h^2/2 h]
        let weight = Matrix2::new(
            12.0 / h.powi(3),
            -6.0 / h.powi(2),
            -6.0 / h.powi(2),
            4.0 / h,
        ) / q;
        // residual = x_row - F x_before
        let jacobian = SMatrix::<f64, 2, 4>::new(-1.0, -h, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0);
        let information = jacobian.transpose() * weight * jacobian;
        let mut part = a.view_mut((2 * row - 2, 2 * row - 2), (4, 4));
        part += information;
    }
    let inverse = a.cholesky().unwrap().inverse();
    let mean = &inverse * b;
    let at = |row: usize| AxisEstimate {
        position: mean[2 * row],
        velocity: mean[2 * row + 1],
        position_variance: inverse[(2 * row, 2 * row)],
        velocity_variance: inverse[(2 * row + 1, 2 * row + 1)],
        covariance: inverse[(2 * row, 2 * row + 1)],
    };
    (0..n).map(at).collect()
}

fn assert_close(row: usize, got: AxisEstimate, exact: AxisEstimate) {
    for (name, got, exact) in [
        ("position", got.position, exact.position),
        ("velocity", got.velocity, exact.velocity),
        (
            "position variance",
            got.position_variance,
            exact.position_variance,
        ),
        (
            "velocity variance",
            got.velocity_variance,
            exact.velocity_variance,
        ),
        ("covariance", got.covariance, exact.covariance),
    ] {
        assert!(
            (got - exact).abs() < 1e-9 * exact.abs().max(1.0),
            "row {row}, {name}: {got}, not {exact}"
        );
    }
}

#[test]
fn smooth_agrees_with_batch_least_squares() {
    let (times, measurements) = series(60, 2);
    let smoothed = AXIS.smooth(&times, &measurements).unwrap();
    for (row, exact) in batch(&AXIS, &times, &measurements).into_iter().enumerate() {
        assert_close(row, smoothed[row].unwrap(), exact);
    }
}

#[test]
fn filter_agrees_with_batch_least_squares_over_the_rows_so_far() {
    let (times, measurements) = series(40, 4);
    let filtered = AXIS.filter(&times, &measurements).unwrap();
    for row in 1..times.len() {
        let exact = *batch(&AXIS, &times[..=row], &measurements[..=row])
            .last()
            .unwrap();
        assert_close(row, filtered.rows[row].unwrap(), exact);
    }
}

/// ln p(measurements after the first | the first) from their joint covariance: initial position and
/// velocity, the twice-integrated white noise q (m^3/3 + m^2 |t - s|/2) with m = min(t, s), and the
/// measurement noise.
fn joint_log_density(
    axis: &ConstantVelocity,
    times: &[f64],
    measurements: &[Option<f64>],
    std: impl Fn(usize) -> f64,
) -> f64 {
    let seen: Vec<(f64, f64, f64)> = times
        .iter()
        .zip(measurements)
        .enumerate()
        .skip(1)
        .filter_map(|(row, (t, z))| z.map(|z| (t - times[0], z, std(row).powi(2))))
        .collect();
    let first = measurements[0].unwrap();
    let r = std(0).powi(2);
    let covariance = DMatrix::from_fn(seen.len(), seen.len(), |i, j| {
        let (t, s) = (seen[i].0, seen[j].0);
        let m = if t < s { t } else { s };
        let motion = axis.process_noise * (m.powi(3) / 3.0 + m * m * (t - s).abs() / 2.0);
        r + axis.initial_velocity_std.powi(2) * t * s
            + motion
            + if i == j { seen[i].2 } else { 0.0 }
    });
    let residual = DVector::from_iterator(seen.len(), seen.iter().map(|(_, z, _)| z - first));
    let factor = covariance.cholesky().unwrap();
    let log_determinant: f64 = factor
        .l()
        .diagonal()
        .iter()
        .map(|l| 2.0 * libm::log(*l))
        .sum();
    let constant = seen.len() as f64 * libm::log(std::f64::consts::TAU);
    -0.5 * (residual.dot(&factor.solve(&residual)) + log_determinant + constant)
}

#[test]
fn log_likelihood_agrees_with_the_joint_density() {
    let (times, measurements) = series(40, 6);
    let filtered = AXIS.filter(&times, &measurements).unwrap();
    let exact = joint_log_density(&AXIS, &times, &measurements, |_| AXIS.measurement_std);
    assert!(
        (filtered.log_likelihood - exact).abs() < 1e-9 * exact.abs(),
        "{}, not {exact}",
        filtered.log_likelihood
    );
}

/// Every third measurement has a noise of its own, from much smaller to much larger than the
/// model's.
#[test]
fn measurements_may_have_a_noise_of_their_own() {
    let (times, measurements) = series(40, 6);
    let own = |row: usize| {
        row.is_multiple_of(3)
            .then(|| AXIS.measurement_std * libm::exp(0.2 * (row as f64 - 20.0)))
    };
    let stds: Vec<Option<f64>> = (0..times.len()).map(own).collect();
    let filtered = AXIS.filter_with_stds(&times, &measurements, &stds).unwrap();
    let std = |row: usize| own(row).unwrap_or(AXIS.measurement_std);
    let exact = joint_log_density(&AXIS, &times, &measurements, std);
    assert!(
        (filtered.log_likelihood - exact).abs() < 1e-9 * exact.abs(),
        "{}, not {exact}",
        filtered.log_likelihood
    );
    for (stds, words) in [
        (
            vec![Some(0.0); 40],
            "`standard deviation of a measurement` is 0",
        ),
        (vec![None; 39], "40 times but 39 measurements"),
    ] {
        let refused = AXIS
            .filter_with_stds(&times, &measurements, &stds)
            .unwrap_err();
        assert!(refused.to_string().contains(words), "{refused}");
    }
}

#[test]
fn update_with_two_sensors_agrees_with_the_information_form() {
    let prior = Gaussian {
        mean: Vector3::new(1.0, -2.0, 0.5),
        covariance: SMatrix::<f64, 3, 3>::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.7),
    };
    let sensor = SMatrix::<f64, 2, 3>::new(1.0, 0.5, 0.0, 0.0, -1.0, 2.0);
    let noise = Matrix2::new(0.4, 0.1, 0.1, 0.3);
    let z = Vector2::new(0.7, 1.1);
    let update = prior.update(&z, &sensor, &noise).unwrap();

    let (p, r) = (
        prior.covariance.try_inverse().unwrap(),
        noise.try_inverse().unwrap(),
    );
    let covariance = (p + sensor.transpose() * r * sensor).try_inverse().unwrap();
    let mean: SVector<f64, 3> = covariance * (p * prior.mean + sensor.transpose() * r * z);
    assert!((update.posterior.mean - mean).norm() < 1e-13);
    assert!((update.posterior.covariance - covariance).norm() < 1e-13);

    let s = sensor * prior.covariance * sensor.transpose() + noise;
    let e = z - sensor * prior.mean;
    let tau = std::f64::consts::TAU;
    let density =
        libm::exp(-0.5 * e.dot(&(s.try_inverse().unwrap() * e))) / (tau * s.determinant().sqrt());
    assert!((libm::exp(update.log_likelihood) / density - 1.0).abs() < 1e-13);
}

#[test]
fn update_with_a_certain_innovation_is_none() {
    let prior = Gaussian {
        mean: Vector2::zeros(),
        covariance: Matrix2::zeros(),
    };
    assert_eq!(
        prior.update(
            &Vector1::new(0.1),
            &RowVector2::new(1.0, 0.0),
            &SMatrix::zeros()
        ),
        None
    );
}

#[test]
fn missing_rows_are_extrapolated_at_the_last_velocity() {
    let measurements = [Some(0.0), Some(0.1), Some(0.2), None, None];
    let rows = AXIS
        .filter(&[0.0, 0.1, 0.2, 0.3, 0.5], &measurements)
        .unwrap()
        .rows;
    let (last, after) = (rows[2].unwrap(), rows[4].unwrap());
    assert!((after.position - (last.position + 0.3 * last.velocity)).abs() < 1e-14);
    assert!(after.velocity == last.velocity && after.position_variance > last.position_variance);
}

#[test]
fn rows_before_the_first_measurement_have_no_estimate() {
    let measurements = [None, None, Some(1.0), Some(1.1)];
    let times = [0.0, 0.1, 0.2, 0.3];
    let filtered = AXIS.filter(&times, &measurements).unwrap().rows;
    let smoothed = AXIS.smooth(&times, &measurements).unwrap();
    for rows in [filtered, smoothed] {
        assert!(rows[0].is_none() && rows[1].is_none() && rows[2].is_some() && rows[3].is_some());
    }
    assert_eq!(AXIS.smooth(&times, &[None; 4]).unwrap(), [None; 4]);
}

/// Without process noise and prior, the smoother is the straight line of least squares.
#[test]
fn smooth_without_process_noise_is_the_regression_line() {
    let axis = ConstantVelocity {
        process_noise: 0.0,
        measurement_std: 0.1,
        initial_velocity_std: 1e3,
    };
    let times: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
    let noise = |i: usize| 0.1 * Streams::new(3).normal(0, i as u32, 0);
    let z: Vec<f64> = times
        .iter()
        .enumerate()
        .map(|(i, t)| 2.0 + 0.7 * t + noise(i))
        .collect();
    let (n, mean_t) = (30.0, times.iter().sum::<f64>() / 30.0);
    let mean_z = z.iter().sum::<f64>() / n;
    let spread: f64 = times.iter().map(|t| (t - mean_t).powi(2)).sum();
    let slope = times
        .iter()
        .zip(&z)
        .map(|(t, z)| (t - mean_t) * (z - mean_z))
        .sum::<f64>()
        / spread;

    let rows = axis
        .smooth(&times, &z.into_iter().map(Some).collect::<Vec<_>>())
        .unwrap();
    for (row, time) in rows.iter().zip(&times) {
        let row = row.unwrap();
        assert!(
            (row.velocity - slope).abs() < 1e-7,
            "{} {slope}",
            row.velocity
        );
        assert!((row.position - (mean_z + slope * (time - mean_t))).abs() < 1e-7);
        assert!((row.velocity_variance / (0.01 / spread) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn fit_process_noise_finds_the_level_that_made_the_series() {
    for seed in 0..4 {
        let (times, measurements) = series(600, 100 + seed);
        let fit = AXIS.fit_process_noise(&times, &measurements).unwrap();
        assert_eq!(fit.optimum, Optimum::Interior);

        // twice the gain in log-likelihood over the truth is chi-squared with one degree of
        // freedom: 10.8 at 0.001
        let truth = AXIS.filter(&times, &measurements).unwrap().log_likelihood;
        let gain = 2.0 * (fit.log_likelihood - truth);
        assert!((0.0..10.8).contains(&gain), "{fit:?}, gain {gain}");

        // a maximum
        for factor in [0.99, 1.01] {
            let other = ConstantVelocity {
                process_noise: factor * fit.process_noise,
                ..AXIS
            };
            assert!(
                other.filter(&times, &measurements).unwrap().log_likelihood < fit.log_likelihood
            );
        }
    }
}

#[test]
fn fit_process_noise_scales_with_the_square_of_the_unit() {
    let (times, measurements) = series(200, 7);
    let metres = AXIS.fit_process_noise(&times, &measurements).unwrap();
    let milli: Vec<Option<f64>> = measurements.iter().map(|z| z.map(|z| 1e3 * z)).collect();
    let axis = ConstantVelocity {
        measurement_std: 1e3 * AXIS.measurement_std,
        initial_velocity_std: 1e3 * AXIS.initial_velocity_std,
        ..AXIS
    };
    let millimetres = axis.fit_process_noise(&times, &milli).unwrap();
    assert!((millimetres.process_noise / metres.process_noise / 1e6 - 1.0).abs() < 1e-5);
}

#[test]
fn fit_process_noise_of_a_series_at_rest_is_at_the_lower_end() {
    let times: Vec<f64> = (0..50).map(|i| 0.1 * f64::from(i)).collect();
    let fit = AXIS.fit_process_noise(&times, &[Some(1.0); 50]).unwrap();
    assert_eq!(fit.optimum, Optimum::LowerEnd);
    assert!(fit.process_noise > 0.0 && fit.log_likelihood.is_finite());
}

#[test]
fn simulated_errors_agree_with_the_stated_variance() {
    // 300 series: squared errors over stated variances average to 1, standard error sqrt(2/300)
    let mut sum = [0.0; 2];
    for seed in 0..300 {
        let draw = Streams::new(seed).of(Purpose::Measure);
        let (h, q) = (0.3, AXIS.process_noise);
        let (mut x, mut v) = (0.0, draw.normal(0, 1, 0));
        let (mut times, mut measurements) = (Vec::new(), Vec::new());
        for row in 0..12u32 {
            let [a, b, r] = draw.normals(u64::from(row), 0, 0);
            if row > 0 {
                x += h * v + (q * h * h * h / 3.0).sqrt() * a;
                v += (0.75 * q * h).sqrt() * a + (0.25 * q * h).sqrt() * b;
            }
            times.push(h * f64::from(row));
            measurements.push((row % 4 != 2).then_some(x + AXIS.measurement_std * r));
        }
        let last = AXIS.filter(&times, &measurements).unwrap().rows[11].unwrap();
        sum[0] += (last.position - x).powi(2) / last.position_variance;
        sum[1] += (last.velocity - v).powi(2) / last.velocity_variance;
    }
    for s in sum {
        assert!(
            (s / 300.0 - 1.0).abs() < 4.0 * (2.0f64 / 300.0).sqrt(),
            "{}",
            s / 300.0
        );
    }
}

#[test]
fn series_out_of_range_is_refused_with_its_place() {
    let refuse = |times: &[f64], z: &[Option<f64>]| AXIS.filter(times, z).unwrap_err();
    assert_eq!(
        refuse(&[0.0], &[]),
        SeriesError::Length {
            times: 1,
            measurements: 0
        }
    );
    let time = refuse(&[0.0, 1.0, 1.0], &[None; 3]);
    assert_eq!(
        time.to_string(),
        "row 2: time 1 s does not rise above 1 s of the row before; sort the rows"
    );
    assert!(matches!(
        refuse(&[f64::NAN], &[None]),
        SeriesError::FirstTime { .. }
    ));
    assert!(matches!(
        refuse(&[0.0, 1.0], &[None, Some(f64::NAN)]),
        SeriesError::Measurement { row: 1, .. }
    ));
    let still = ConstantVelocity {
        measurement_std: 0.0,
        ..AXIS
    }
    .filter(&[], &[])
    .unwrap_err();
    assert_eq!(
        still.to_string(),
        "`measurement_std` is 0; it must be finite and > 0"
    );
    let few = AXIS
        .fit_process_noise(&[0.0, 1.0], &[Some(0.0), Some(1.0)])
        .unwrap_err();
    assert_eq!(few, SeriesError::TooFew { measurements: 2 });
    assert_eq!(AXIS.filter(&[], &[]).unwrap().rows, []);
}

#[test]
fn smooth_with_a_hopeless_prior_is_an_error_not_nan() {
    let axis = ConstantVelocity {
        process_noise: 0.0,
        measurement_std: 1e-6,
        initial_velocity_std: 1e9,
    };
    let smoothed = axis.smooth(&[0.0, 1.0], &[Some(0.0), Some(1.0)]);
    assert_eq!(smoothed, Err(SeriesError::Singular { row: 1 }));
}
