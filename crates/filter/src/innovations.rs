//! The likelihood of a constant-velocity axis for several levels of process noise side by side:
//! [`log_likelihoods`].
//!
//! The filter of [`ConstantVelocity`] written out for its two numbers, in units of measurement_std
//! (so that R = 1) and from the first measurement: ln p = −½ Σ (y²/S + ln S R + ln 2π) over the
//! measurements after it, y the innovation and S its variance (Schweppe 1965).

use crate::ConstantVelocity;
use crate::kalman::LN_TAU;
use crate::series::Series;

/// Variances whose product is taken before its logarithm: none of them is below 1, and a product of
/// so many below 1e77 is finite.
const FACTORS: usize = 4;

/// ln p(measurements after the first | the first) for each process noise.
pub(crate) fn log_likelihoods<const W: usize>(
    axis: &ConstantVelocity,
    process_noise: [f64; W],
    series: &Series<'_>,
) -> [f64; W] {
    let unit = 1.0 / axis.measurement_std;
    let mut rows = series
        .rows()
        .filter_map(|(_, time, measurement)| Some((time, measurement?)));
    let Some((mut before, first)) = rows.next() else {
        return [0.0; W];
    };
    let mut axes = Axes::start(
        process_noise.map(|q| q * unit * unit),
        axis.initial_velocity_std * unit,
    );
    let mut count = 0;
    for (time, position) in rows {
        axes.predict(time - before);
        axes.update((position - first) * unit);
        count += 1;
        if count % FACTORS == 0 {
            axes.take_logarithm();
        }
        before = time;
    }
    axes.take_logarithm();
    let constant = f64::from(count as u32) * (LN_TAU - 2.0 * libm::log(unit));
    axes.sum.map(|sum| -0.5 * (sum + constant))
}

/// Mean and covariance of position and velocity for `W` levels of process noise.
struct Axes<const W: usize> {
    process_noise: [f64; W],
    position: [f64; W],
    velocity: [f64; W],
    position_variance: [f64; W],
    covariance: [f64; W],
    velocity_variance: [f64; W],
    /// Σ y²/S + ln S.
    sum: [f64; W],
    /// Π S of the last measurements, still to be added.
    product: [f64; W],
}

impl<const W: usize> Axes<W> {
    /// At a first measurement, 0: there, with its noise, and at rest give or take `velocity_std`.
    fn start(process_noise: [f64; W], velocity_std: f64) -> Self {
        Self {
            process_noise,
            position: [0.0; W],
            velocity: [0.0; W],
            position_variance: [1.0; W],
            covariance: [0.0; W],
            velocity_variance: [velocity_std * velocity_std; W],
            sum: [0.0; W],
            product: [1.0; W],
        }
    }

    /// `h` (s) later.
    #[inline(always)]
    fn predict(&mut self, h: f64) {
        let (half_square, third_cube) = (h * h / 2.0, h * h * h / 3.0);
        for k in 0..W {
            let q = self.process_noise[k];
            let spread = h * self.velocity_variance[k];
            self.position[k] += h * self.velocity[k];
            self.position_variance[k] += h * (2.0 * self.covariance[k] + spread) + q * third_cube;
            self.covariance[k] += spread + q * half_square;
            self.velocity_variance[k] += q * h;
        }
    }

    /// Given a position.
    #[inline(always)]
    fn update(&mut self, measured: f64) {
        for k in 0..W {
            let variance = self.position_variance[k] + 1.0;
            let innovation = measured - self.position[k];
            let inverse = 1.0 / variance;
            let gain = [
                self.position_variance[k] * inverse,
                self.covariance[k] * inverse,
            ];
            self.position[k] += gain[0] * innovation;
            self.velocity[k] += gain[1] * innovation;
            self.velocity_variance[k] -= gain[1] * self.covariance[k];
            self.position_variance[k] = gain[0];
            self.covariance[k] = gain[1];
            self.sum[k] += innovation * innovation * inverse;
            self.product[k] *= variance;
        }
    }

    fn take_logarithm(&mut self) {
        for k in 0..W {
            self.sum[k] += libm::log(self.product[k]);
            self.product[k] = 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Purpose, Streams};

    #[test]
    fn likelihoods_are_those_of_the_filter_on_matrices() {
        let axis = ConstantVelocity {
            process_noise: 0.0,
            measurement_std: 1e-3,
            initial_velocity_std: 0.3,
        };
        let draw = Streams::new(5).of(Purpose::Measure).at(0);
        let times: Vec<f64> = (0..400)
            .map(|row| 0.03 * f64::from(row) + if row > 200 { 2.0 } else { 0.0 })
            .collect();
        let position = |row: usize| {
            3.0 + libm::sin(2.0 * times[row]) * 0.05 + 1e-3 * draw.normals::<1>(row as u32, 0)[0]
        };
        let measurements: Vec<Option<f64>> = (0..400)
            .map(|row| (row % 7 != 0).then(|| position(row)))
            .collect();
        let series = Series::new(&times, &measurements).expect("a series");
        let levels = [1e-14, 1e-8, 1e-5, 1e-2, 10.0, 1e4];
        for (q, value) in levels
            .into_iter()
            .zip(log_likelihoods(&axis, levels, &series))
        {
            let expected = ConstantVelocity {
                process_noise: q,
                ..axis
            }
            .filter(&times, &measurements)
            .expect("a series")
            .log_likelihood;
            assert!(
                (value - expected).abs() < 1e-9 * expected.abs(),
                "{q}: {value}, not {expected}"
            );
        }
    }
}
