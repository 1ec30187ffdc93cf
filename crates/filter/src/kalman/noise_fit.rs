//! The process noise of a constant-velocity axis by maximum likelihood.

use crate::kalman::constant_velocity::ConstantVelocity;
use crate::kalman::gaussian::LN_TAU;
use crate::kalman::series::{Series, SeriesError};

/// Decades of process noise searched either side of the centre.
const DECADES: usize = 9;

/// Innovation variances whose product is taken before its logarithm: a product of so many between
/// 1e-77 and 1e77 is a number.
const FACTORS: u32 = 4;

/// The process noise that makes a series of measurements most probable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoiseFit {
    /// q \[unit²/s³\].
    pub process_noise: f64,
    /// ln p(measurements after the first | the first, q).
    pub log_likelihood: f64,
    /// Place of q in the range searched.
    pub optimum: Optimum,
}

/// Place at which an optimum was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Optimum {
    /// Inside the range.
    Interior,
    /// At the lower end: the measurements are consistent with a constant velocity.
    LowerEnd,
    /// At the upper end: the measurement noise is negligible compared with the motion.
    UpperEnd,
}

impl ConstantVelocity {
    /// The process noise of greatest likelihood; this model's own is not used.
    ///
    /// The search is over ln q within nine decades either side of measurement_std²/h³ (h the median
    /// step), where a step's process noise equals the measurement's: a grid of decades, then
    /// Brent's method about its best point. The result depends on the arguments alone.
    ///
    /// # Errors
    /// If the model or the series is out of range or has fewer than 3 measurements.
    pub fn fit_process_noise(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<ProcessNoiseFit, SeriesError> {
        self.fit_process_noise_with_stds(times, measurements, &[])
    }

    /// Same as [`fit_process_noise`](Self::fit_process_noise), with standard deviations of single
    /// measurements, one per row or none at all. Rows without one have the model's.
    ///
    /// # Errors
    /// If the model or the series is out of range or has fewer than 3 measurements, or a standard
    /// deviation is.
    pub fn fit_process_noise_with_stds(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
        stds: &[Option<f64>],
    ) -> Result<ProcessNoiseFit, SeriesError> {
        let axis = ConstantVelocity {
            process_noise: 0.0,
            ..*self
        };
        axis.check()?;
        let series = Series::new(times, measurements)?.with_stds(stds)?;
        let measurements = series.measured();
        if measurements < 3 {
            return Err(SeriesError::TooFew { measurements });
        }
        let centre = libm::log(self.measurement_std * self.measurement_std)
            - 3.0 * libm::log(series.median_step());
        Ok(maximum_likelihood(&axis, &series, centre))
    }
}

/// The likelihood of one level of process noise.
#[derive(Clone, Copy)]
struct Point {
    log_q: f64,
    log_likelihood: f64,
}

/// The best process noise within [`DECADES`] of e^`centre`.
fn maximum_likelihood(
    axis: &ConstantVelocity,
    series: &Series<'_>,
    centre: f64,
) -> ProcessNoiseFit {
    let decade = |i: usize| centre + (i as f64 - DECADES as f64) * std::f64::consts::LN_10;
    let grid: [Point; 2 * DECADES + 1] = points(axis, series, std::array::from_fn(decade));
    let highest = (1..grid.len()).fold(0, |best, i| {
        if grid[i].log_likelihood > grid[best].log_likelihood {
            i
        } else {
            best
        }
    });
    let (peak, optimum) = match highest {
        0 => (grid[0], Optimum::LowerEnd),
        i if i + 1 == grid.len() => (grid[i], Optimum::UpperEnd),
        i => {
            let bracket = [grid[i - 1], grid[i], grid[i + 1]];
            let at = |log_q| points(axis, series, [log_q])[0];
            (maximum(bracket, at), Optimum::Interior)
        }
    };
    ProcessNoiseFit {
        process_noise: libm::exp(peak.log_q),
        log_likelihood: peak.log_likelihood,
        optimum,
    }
}

fn points<const W: usize>(
    axis: &ConstantVelocity,
    series: &Series<'_>,
    log_q: [f64; W],
) -> [Point; W] {
    let values = log_likelihoods(axis, log_q.map(libm::exp), series);
    std::array::from_fn(|k| Point {
        log_q: log_q[k],
        log_likelihood: values[k],
    })
}

/// The maximum to 1e-6 of a function with one peak between the outer two of three points, the
/// middle one of which is highest. Each step goes to the vertex of the parabola through the best
/// three points so far. Golden section replaces it where these steps converge too slowly (Brent
/// 1973, chapter 5).
fn maximum([left, middle, right]: [Point; 3], at: impl Fn(f64) -> Point) -> Point {
    const TOLERANCE: f64 = 5e-7;
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let (mut low, mut high) = (left.log_q, right.log_q);
    let (mut best, mut second, mut third) = if left.log_likelihood > right.log_likelihood {
        (middle, left, right)
    } else {
        (middle, right, left)
    };
    let (mut step, mut step_before) = (high - low, high - low);
    while f64::max(best.log_q - low, high - best.log_q) > 2.0 * TOLERANCE {
        // the parabola's step if it stays inside and halves the step before last, else golden section
        let parabolic = to_vertex(best, second, third);
        let converges = parabolic.abs() < 0.5 * step_before.abs()
            && low < best.log_q + parabolic
            && best.log_q + parabolic < high;
        let larger_side = if best.log_q - low > high - best.log_q {
            low - best.log_q
        } else {
            high - best.log_q
        };
        (step_before, step) = if converges {
            (step, parabolic)
        } else {
            (larger_side, GOLDEN * larger_side)
        };

        // evaluate no nearer to the best point than the tolerance, and inside the bracket
        let apart = step.signum() * step.abs().max(TOLERANCE);
        let inside = low < best.log_q + apart && best.log_q + apart < high;
        let new = at(best.log_q + if inside { apart } else { -apart });

        // shrink the bracket to the worse of the two, and rank the points again
        let (worse, better) = if new.log_likelihood > best.log_likelihood {
            (best, new)
        } else {
            (new, best)
        };
        *(if worse.log_q < better.log_q {
            &mut low
        } else {
            &mut high
        }) = worse.log_q;
        best = better;
        if worse.log_likelihood >= second.log_likelihood {
            (third, second) = (second, worse);
        } else if worse.log_likelihood >= third.log_likelihood {
            third = worse;
        }
    }
    best
}

/// From `a` to the vertex of the parabola through three points; not finite where they are on a
/// line.
fn to_vertex(a: Point, b: Point, c: Point) -> f64 {
    let (to_b, to_c) = (b.log_q - a.log_q, c.log_q - a.log_q);
    let rise_b = (b.log_likelihood - a.log_likelihood) * to_c;
    let rise_c = (c.log_likelihood - a.log_likelihood) * to_b;
    0.5 * (rise_b * to_c - rise_c * to_b) / (rise_b - rise_c)
}

/// ln p(measurements after the first | the first) for each level of process noise.
///
/// The innovations form of the likelihood (Schweppe 1965): ln p = −½ Σ (y²/S + ln S R + ln 2π) over
/// the measurements after the first, y the innovation and S its variance in units of R.
fn log_likelihoods<const W: usize>(
    axis: &ConstantVelocity,
    process_noise: [f64; W],
    series: &Series<'_>,
) -> [f64; W] {
    let unit = 1.0 / axis.measurement_std;
    let variance = |row| series.std(row).map_or(1.0, |std| std * unit * std * unit);
    let mut rows = series
        .rows()
        .filter_map(|(row, time, measurement)| Some((time, measurement?, variance(row))));
    let Some((mut before, first, variance)) = rows.next() else {
        return [0.0; W];
    };
    let mut filters = Filters::start(
        process_noise.map(|q| q * unit * unit),
        variance,
        axis.initial_velocity_std * unit,
    );
    let mut count = 0;
    for (time, position, variance) in rows {
        filters.predict(time - before);
        filters.update((position - first) * unit, variance);
        count += 1;
        if count % FACTORS == 0 {
            filters.add_logarithm();
        }
        before = time;
    }
    filters.add_logarithm();
    let constant = f64::from(count) * (LN_TAU - 2.0 * libm::log(unit));
    filters.sum.map(|sum| -0.5 * (sum + constant))
}

/// The filters of [`ConstantVelocity`] for `W` levels of process noise side by side, written out
/// for their two numbers. Units are those of measurement_std, so that R = 1 but for measurements
/// with a noise of their own. Positions are relative to the first measurement.
struct Filters<const W: usize> {
    process_noise: [f64; W],
    position: [f64; W],
    velocity: [f64; W],
    position_variance: [f64; W],
    covariance: [f64; W],
    velocity_variance: [f64; W],
    /// Σ y²/S + ln S.
    sum: [f64; W],
    /// Π S of the last measurements, whose logarithm is not in `sum` yet.
    product: [f64; W],
}

impl<const W: usize> Filters<W> {
    /// At the first measurement, 0, whose variance is `variance`, at rest with a standard deviation
    /// of `velocity_std`.
    fn start(process_noise: [f64; W], variance: f64, velocity_std: f64) -> Self {
        Self {
            process_noise,
            position: [0.0; W],
            velocity: [0.0; W],
            position_variance: [variance; W],
            covariance: [0.0; W],
            velocity_variance: [velocity_std * velocity_std; W],
            sum: [0.0; W],
            product: [1.0; W],
        }
    }

    /// The states `h` \[s\] later.
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

    /// The states given a position too, whose variance is `noise`.
    #[inline(always)]
    fn update(&mut self, measured: f64, noise: f64) {
        for k in 0..W {
            let variance = self.position_variance[k] + noise;
            let innovation = measured - self.position[k];
            let inverse = 1.0 / variance;
            let gain = [
                self.position_variance[k] * inverse,
                self.covariance[k] * inverse,
            ];
            self.position[k] += gain[0] * innovation;
            self.velocity[k] += gain[1] * innovation;
            self.velocity_variance[k] -= gain[1] * self.covariance[k];
            self.position_variance[k] = gain[0] * noise;
            self.covariance[k] = gain[1] * noise;
            self.sum[k] += innovation * innovation * inverse;
            self.product[k] *= variance;
        }
    }

    fn add_logarithm(&mut self) {
        for k in 0..W {
            self.sum[k] += libm::log(self.product[k]);
            self.product[k] = 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::{Purpose, Streams};

    #[test]
    fn maximum_is_found_of_smooth_and_of_pointed_functions() {
        let functions: [&dyn Fn(f64) -> f64; 4] = [
            &|x| -(x - 0.3) * (x - 0.3),
            &|x| -(x + 0.7).abs(),
            &|x| (x + 2.0) * libm::exp(-2.0 * x),
            &|x| -libm::exp(-3.0 * x) - x,
        ];
        for (f, exact) in functions
            .into_iter()
            .zip([0.3, -0.7, -1.5, libm::log(3.0) / 3.0])
        {
            let at = |log_q: f64| Point {
                log_q,
                log_likelihood: f(log_q),
            };
            let found = maximum([-2.0, exact + 0.2, 1.5].map(at), at);
            assert!(
                (found.log_q - exact).abs() < 1e-6,
                "{} instead of {exact}",
                found.log_q
            );
        }
    }

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

    /// Noise of its own for every third row: the likelihood is that of the filter that is written
    /// with matrices.
    #[test]
    fn log_likelihoods_take_the_noise_of_each_measurement() {
        let axis = ConstantVelocity {
            process_noise: 0.0,
            measurement_std: 1e-3,
            initial_velocity_std: 0.3,
        };
        let times: Vec<f64> = (0..90).map(|row| 0.03 * f64::from(row)).collect();
        let measurements: Vec<Option<f64>> = times
            .iter()
            .map(|t| Some(0.1 * libm::sin(9.0 * t)))
            .collect();
        let stds: Vec<Option<f64>> = (0..90)
            .map(|row| (row % 3 == 0).then_some(2e-5 * f64::from(1 + row)))
            .collect();
        let series = Series::new(&times, &measurements).and_then(|s| s.with_stds(&stds));
        let series = series.expect("a series");
        let levels = [1e-8, 1e-2, 10.0];
        for (q, value) in levels
            .into_iter()
            .zip(log_likelihoods(&axis, levels, &series))
        {
            let axis = ConstantVelocity {
                process_noise: q,
                ..axis
            };
            let filtered = axis.filter_with_stds(&times, &measurements, &stds);
            let expected = filtered.expect("a series").log_likelihood;
            let plain = axis.filter(&times, &measurements).expect("a series");
            assert!(
                (value - expected).abs() < 1e-9 * expected.abs(),
                "{q}: {value} {expected}"
            );
            // the noise matters a thousand times more than the two may differ
            let without = plain.log_likelihood;
            assert!(
                (value - without).abs() > 1e-6 * expected.abs(),
                "{q}: {value} {without}"
            );
        }
    }
}
