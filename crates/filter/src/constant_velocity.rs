//! One axis that moves at nearly constant velocity: Kalman filter, smoother and maximum-likelihood noise.
//!
//! State (position, velocity); the acceleration is white noise of level q [unit²/s³]. Over a step h, exactly
//! (Bar-Shalom, Li & Kirubarajan 2001, section 6.2.2):
//!
//! F = [1 h; 0 1],  Q = q [h³/3 h²/2; h²/2 h],  H = [1 0],  R = measurement_std².
//!
//! The unit is the axis's own: m or rad (angles unwrapped).

use nalgebra::{Matrix1, Matrix2, RowVector2, Vector1, Vector2};

use crate::Gaussian;

/// A constant-velocity model of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantVelocity {
    /// q, the level of the white-noise acceleration [unit²/s³], >= 0.
    pub process_noise: f64,
    /// Standard deviation of one position measurement [unit], > 0.
    pub measurement_std: f64,
    /// Standard deviation of the velocity about 0 at the first measurement [unit/s], > 0.
    pub initial_velocity_std: f64,
}

/// The estimate of one axis at one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEstimate {
    /// Position [unit].
    pub position: f64,
    /// Velocity [unit/s].
    pub velocity: f64,
    /// Variance of the position [unit²].
    pub position_variance: f64,
    /// Variance of the velocity [unit²/s²].
    pub velocity_variance: f64,
}

/// A series' forward pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// One estimate a row; `None` before the first measurement.
    pub rows: Vec<Option<AxisEstimate>>,
    /// ln p(measurements after the first | the first).
    pub log_likelihood: f64,
}

/// The process noise that makes a series of measurements most probable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoiseFit {
    /// q [unit²/s³].
    pub process_noise: f64,
    /// ln p(measurements after the first | the first, q).
    pub log_likelihood: f64,
    /// Where q lies in the range searched.
    pub optimum: Optimum,
}

/// Where an optimum was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Optimum {
    /// Inside the range.
    Interior,
    /// At the lower end: the series moves at constant velocity as far as its noise tells.
    LowerEnd,
    /// At the upper end: the measurement noise is negligible beside the motion.
    UpperEnd,
}

/// Why a series was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeriesError {
    /// Times and measurements differ in number.
    #[error("there are {times} times but {measurements} measurements; give one (or None) per time")]
    Length {
        /// Number of times.
        times: usize,
        /// Number of measurements.
        measurements: usize,
    },
    /// Times do not rise.
    #[error(
        "row {row}: time {time} s does not rise above {before} s of the row before; sort the rows"
    )]
    Time {
        /// The later row.
        row: usize,
        /// Its time.
        time: f64,
        /// The time before.
        before: f64,
    },
    /// A measurement is NaN or infinite.
    #[error(
        "row {row}: the measurement is {value}; it must be finite; give None where there is none"
    )]
    Measurement {
        /// The row.
        row: usize,
        /// The value.
        value: f64,
    },
    /// A parameter of the model is out of range.
    #[error("`{name}` is {value}; it must be finite and {rule}")]
    Parameter {
        /// The field's name.
        name: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// Rounding made a predicted covariance singular.
    #[error(
        "row {row}: the predicted covariance is singular to rounding; `initial_velocity_std` must be nearer the speeds that occur"
    )]
    Singular {
        /// The row.
        row: usize,
    },
    /// Too few measurements to tell the process noise.
    #[error("there are {measurements} measurements; fitting the process noise takes at least 3")]
    TooFew {
        /// Their number.
        measurements: usize,
    },
}

/// One row of the forward pass: the state before its measurement and after.
#[derive(Clone, Copy)]
struct Step {
    predicted: Gaussian<2>,
    filtered: Gaussian<2>,
    log_likelihood: f64,
}

impl ConstantVelocity {
    /// The state at a first measurement: there, with its noise, and at rest give or take `initial_velocity_std`.
    #[must_use]
    pub fn start(&self, position: f64) -> Gaussian<2> {
        Gaussian {
            mean: Vector2::new(position, 0.0),
            covariance: Matrix2::new(
                square(self.measurement_std),
                0.0,
                0.0,
                square(self.initial_velocity_std),
            ),
        }
    }

    /// The state `h` [s] later.
    #[must_use]
    pub fn predict(&self, state: &Gaussian<2>, h: f64) -> Gaussian<2> {
        let noise = Matrix2::new(h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h) * self.process_noise;
        state.predict(&transition(h), &noise)
    }

    /// The state given a position too, and ln p(position | state).
    ///
    /// # Panics
    /// If `measurement_std` is not positive.
    #[must_use]
    pub fn update(&self, state: &Gaussian<2>, position: f64) -> (Gaussian<2>, f64) {
        let noise = Matrix1::new(square(self.measurement_std));
        let Some(update) =
            state.update(&Vector1::new(position), &RowVector2::new(1.0, 0.0), &noise)
        else {
            panic!(
                "measurement_std is {}; it must be > 0",
                self.measurement_std
            );
        };
        (update.posterior, update.log_likelihood)
    }

    /// The Kalman filter over a series: `times` [s] rise, a measurement may be missing.
    ///
    /// Each row is estimated from the rows up to it; missing rows are extrapolated.
    ///
    /// # Errors
    /// If the model or the series is out of range.
    pub fn filter(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<Filtered, SeriesError> {
        self.check()?;
        check_series(times, measurements)?;
        let mut log_likelihood = 0.0;
        let mut rows = vec![None; times.len()];
        self.forward(times, measurements, |row, step| {
            log_likelihood += step.log_likelihood;
            rows[row] = Some(AxisEstimate::from(step.filtered));
        });
        Ok(Filtered {
            rows,
            log_likelihood,
        })
    }

    /// The fixed-interval smoother over a series (Rauch, Tung & Striebel 1965): each row is estimated from all rows.
    ///
    /// Rows before the first measurement are `None`, as in [`filter`](Self::filter).
    ///
    /// ```
    /// # use stickslip_filter::ConstantVelocity;
    /// let axis = ConstantVelocity { process_noise: 1e-3, measurement_std: 1e-4, initial_velocity_std: 1.0 };
    /// let rows = axis.smooth(&[0.0, 0.1, 0.2], &[Some(0.0), None, Some(0.02)])?;
    /// assert!((rows[1].unwrap().position - 0.01).abs() < 1e-6);
    /// # Ok::<(), stickslip_filter::SeriesError>(())
    /// ```
    ///
    /// # Errors
    /// If the model or the series is out of range.
    pub fn smooth(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<Vec<Option<AxisEstimate>>, SeriesError> {
        self.check()?;
        check_series(times, measurements)?;
        let mut steps = Vec::with_capacity(times.len());
        self.forward(times, measurements, |row, step| steps.push((row, step)));

        let mut rows = vec![None; times.len()];
        let mut later: Option<(Gaussian<2>, Gaussian<2>)> = None;
        for &(row, step) in steps.iter().rev() {
            let smoothed = match later {
                None => step.filtered,
                Some((predicted, smoothed)) => step
                    .filtered
                    .smooth(
                        &transition(times[row + 1] - times[row]),
                        &predicted,
                        &smoothed,
                    )
                    .ok_or(SeriesError::Singular { row: row + 1 })?,
            };
            rows[row] = Some(AxisEstimate::from(smoothed));
            later = Some((step.predicted, smoothed));
        }
        Ok(rows)
    }

    /// The process noise of greatest likelihood; this model's own is not used.
    ///
    /// The search is over ln q within nine decades either side of measurement_std²/h³ (h the median step), where a step's
    /// process noise equals the measurement's: a grid of half-decades, then golden section about its best point. The
    /// result depends on the arguments alone.
    ///
    /// # Errors
    /// If the model or the series is out of range or has fewer than 3 measurements.
    pub fn fit_process_noise(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<ProcessNoiseFit, SeriesError> {
        ConstantVelocity {
            process_noise: 0.0,
            ..*self
        }
        .check()?;
        check_series(times, measurements)?;
        let found = measurements.iter().flatten().count();
        if found < 3 {
            return Err(SeriesError::TooFew {
                measurements: found,
            });
        }
        let centre = libm::log(square(self.measurement_std)) - 3.0 * libm::log(median_step(times));
        let objective = |log_q: f64| self.log_likelihood_at(libm::exp(log_q), times, measurements);
        Ok(search(centre, objective))
    }

    fn log_likelihood_at(
        &self,
        process_noise: f64,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> f64 {
        let mut sum = 0.0;
        let model = ConstantVelocity {
            process_noise,
            ..*self
        };
        model.forward(times, measurements, |_, step| sum += step.log_likelihood);
        sum
    }

    /// Calls `visit(row, step)` on every row from the first measurement on.
    fn forward(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
        mut visit: impl FnMut(usize, Step),
    ) {
        let mut before: Option<(f64, Gaussian<2>)> = None;
        for (row, (&time, &measurement)) in times.iter().zip(measurements).enumerate() {
            let step = match (before, measurement) {
                (Some((then, state)), _) => {
                    self.step(&self.predict(&state, time - then), measurement)
                }
                (None, Some(position)) => Step::at_start(self.start(position)),
                (None, None) => continue,
            };
            visit(row, step);
            before = Some((time, step.filtered));
        }
    }

    fn step(&self, predicted: &Gaussian<2>, measurement: Option<f64>) -> Step {
        let (filtered, log_likelihood) = match measurement {
            Some(position) => self.update(predicted, position),
            None => (*predicted, 0.0),
        };
        Step {
            predicted: *predicted,
            filtered,
            log_likelihood,
        }
    }

    fn check(&self) -> Result<(), SeriesError> {
        let positive = |name, value: f64| match value {
            v if square(v).is_normal() && v > 0.0 => Ok(()),
            _ => Err(SeriesError::Parameter {
                name,
                value,
                rule: "> 0",
            }),
        };
        positive("measurement_std", self.measurement_std)?;
        positive("initial_velocity_std", self.initial_velocity_std)?;
        let value = self.process_noise;
        if !(value.is_finite() && value >= 0.0) {
            return Err(SeriesError::Parameter {
                name: "process_noise",
                value,
                rule: ">= 0",
            });
        }
        Ok(())
    }
}

impl Step {
    fn at_start(state: Gaussian<2>) -> Self {
        Step {
            predicted: state,
            filtered: state,
            log_likelihood: 0.0,
        }
    }
}

impl From<Gaussian<2>> for AxisEstimate {
    fn from(state: Gaussian<2>) -> Self {
        AxisEstimate {
            position: state.mean[0],
            velocity: state.mean[1],
            position_variance: state.covariance[(0, 0)],
            velocity_variance: state.covariance[(1, 1)],
        }
    }
}

fn transition(h: f64) -> Matrix2<f64> {
    Matrix2::new(1.0, h, 0.0, 1.0)
}

fn square(x: f64) -> f64 {
    x * x
}

fn check_series(times: &[f64], measurements: &[Option<f64>]) -> Result<(), SeriesError> {
    if times.len() != measurements.len() {
        return Err(SeriesError::Length {
            times: times.len(),
            measurements: measurements.len(),
        });
    }
    for (row, pair) in times.windows(2).enumerate() {
        let h = pair[1] - pair[0];
        if !(h.is_finite() && h > 0.0) {
            return Err(SeriesError::Time {
                row: row + 1,
                time: pair[1],
                before: pair[0],
            });
        }
    }
    let broken = measurements
        .iter()
        .enumerate()
        .find_map(|(row, m)| m.filter(|v| !v.is_finite()).map(|v| (row, v)));
    match broken {
        Some((row, value)) => Err(SeriesError::Measurement { row, value }),
        None => Ok(()),
    }
}

fn median_step(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps[steps.len() / 2]
}

/// Maximises `objective(ln q)` around `centre`.
fn search(centre: f64, objective: impl Fn(f64) -> f64) -> ProcessNoiseFit {
    const HALF_DECADE: f64 = std::f64::consts::LN_10 / 2.0;
    const REACH: i32 = 18;
    let at = |i: i32| centre + f64::from(i) * HALF_DECADE;
    let (mut best, mut highest) = (-REACH, objective(at(-REACH)));
    for i in 1 - REACH..=REACH {
        let value = objective(at(i));
        if value > highest {
            (best, highest) = (i, value);
        }
    }
    let optimum = match best {
        i if i == -REACH => Optimum::LowerEnd,
        REACH => Optimum::UpperEnd,
        _ => Optimum::Interior,
    };
    let log_q = match optimum {
        Optimum::Interior => golden_section(at(best - 1), at(best + 1), &objective),
        _ => at(best),
    };
    ProcessNoiseFit {
        process_noise: libm::exp(log_q),
        log_likelihood: objective(log_q),
        optimum,
    }
}

/// The maximum of a function with one peak in [low, high], to 1e-6.
fn golden_section(mut low: f64, mut high: f64, objective: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut at_a, mut at_b) = (objective(a), objective(b));
    while high - low > 1e-6 {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - SHARE * (high - low);
            at_a = objective(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + SHARE * (high - low);
            at_b = objective(b);
        }
    }
    0.5 * (low + high)
}
