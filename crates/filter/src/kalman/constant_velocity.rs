//! One axis that moves at nearly constant velocity: Kalman filter and smoother.
//!
//! State (position, velocity); the acceleration is white noise of level q \[unit²/s³\]. Over a step
//! h, exactly (Bar-Shalom, Li & Kirubarajan 2001, section 6.2.2):
//!
//! F = [1 h; 0 1],  Q = q [h³/3 h²/2; h²/2 h],  H = [1 0],  R = measurement_std².
//!
//! The unit is the axis's own: m or rad (angles unwrapped).

use nalgebra::{Matrix1, Matrix2, RowVector2, Vector1, Vector2};

use crate::kalman::gaussian::Gaussian;
use crate::kalman::series::{Series, SeriesError};

/// A constant-velocity model of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantVelocity {
    /// q, the level of the white-noise acceleration \[unit²/s³\], >= 0.
    pub process_noise: f64,
    /// Standard deviation of one position measurement \[unit\], > 0.
    pub measurement_std: f64,
    /// Standard deviation of the velocity about 0 at the first measurement \[unit/s\], > 0.
    pub initial_velocity_std: f64,
}

/// The estimate of one axis at one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEstimate {
    /// Position \[unit\].
    pub position: f64,
    /// Velocity \[unit/s\].
    pub velocity: f64,
    /// Variance of the position \[unit²\].
    pub position_variance: f64,
    /// Variance of the velocity \[unit²/s²\].
    pub velocity_variance: f64,
    /// Covariance of position and velocity \[unit²/s\].
    pub covariance: f64,
}

/// A series' forward pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// One estimate a row; `None` before the first measurement.
    pub rows: Vec<Option<AxisEstimate>>,
    /// ln p(measurements after the first | the first).
    pub log_likelihood: f64,
}

/// One row of the forward pass: the state before its measurement and after.
#[derive(Clone, Copy)]
struct Step {
    predicted: Gaussian<2>,
    filtered: Gaussian<2>,
    /// ln p(measurement | rows before), 0 where there is none.
    log_likelihood: f64,
}

impl ConstantVelocity {
    /// The state at a first measurement: the position measured, and a velocity of 0 with a standard
    /// deviation of `initial_velocity_std`.
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

    /// The state `h` \[s\] later.
    #[must_use]
    pub fn predict(&self, state: &Gaussian<2>, h: f64) -> Gaussian<2> {
        let noise = Matrix2::new(h * h * h / 3.0, h * h / 2.0, h * h / 2.0, h) * self.process_noise;
        state.predict(&transition(h), &noise)
    }

    /// The state given a measured position, and ln p(position | state).
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

    /// The Kalman filter over a series: `times` \[s\] rise, a measurement may be missing.
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
        self.filter_with_stds(times, measurements, &[])
    }

    /// Same as [`filter`](Self::filter), with standard deviations of single measurements, one per
    /// row or none at all. Rows without one have the model's.
    ///
    /// # Errors
    /// If the model or the series is out of range, or a standard deviation is.
    pub fn filter_with_stds(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
        stds: &[Option<f64>],
    ) -> Result<Filtered, SeriesError> {
        self.check()?;
        let series = Series::new(times, measurements)?.with_stds(stds)?;
        let mut log_likelihood = 0.0;
        let mut rows = vec![None; times.len()];
        self.forward(&series, |row, step| {
            log_likelihood += step.log_likelihood;
            rows[row] = Some(AxisEstimate::from(step.filtered));
        });
        Ok(Filtered {
            rows,
            log_likelihood,
        })
    }

    /// The fixed-interval smoother over a series (Rauch, Tung & Striebel 1965): each row is
    /// estimated from all rows.
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
        let series = Series::new(times, measurements)?;
        let mut steps = Vec::with_capacity(times.len());
        self.forward(&series, |row, step| steps.push((row, step)));

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

    /// Calls `visit(row, step)` on every row from the first measurement on.
    fn forward(&self, series: &Series<'_>, mut visit: impl FnMut(usize, Step)) {
        let mut before: Option<(f64, Gaussian<2>)> = None;
        for (row, time, measurement) in series.rows() {
            let model = Self {
                measurement_std: series.std(row).unwrap_or(self.measurement_std),
                ..*self
            };
            let step = match (before, measurement) {
                (Some((then, state)), _) => {
                    model.step(&self.predict(&state, time - then), measurement)
                }
                (None, Some(position)) => Step::at_start(model.start(position)),
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

    pub(crate) fn check(&self) -> Result<(), SeriesError> {
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
            covariance: state.covariance[(0, 1)],
        }
    }
}

impl From<AxisEstimate> for Gaussian<2> {
    fn from(axis: AxisEstimate) -> Self {
        let (p, v, both) = (
            axis.position_variance,
            axis.velocity_variance,
            axis.covariance,
        );
        Gaussian {
            mean: Vector2::new(axis.position, axis.velocity),
            covariance: Matrix2::new(p, both, both, v),
        }
    }
}

fn transition(h: f64) -> Matrix2<f64> {
    Matrix2::new(1.0, h, 0.0, 1.0)
}

fn square(x: f64) -> f64 {
    x * x
}
