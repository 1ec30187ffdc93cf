//! A series of measurements of one axis, checked.

/// Reason why a series was refused.
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
    /// The first time is NaN or infinite.
    #[error("row 0: time is {time} s; it must be finite")]
    FirstTime {
        /// The time.
        time: f64,
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
        /// Rule for the value.
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
    /// Too few measurements to fit the process noise.
    #[error("there are {measurements} measurements; fitting the process noise takes at least 3")]
    TooFew {
        /// Their number.
        measurements: usize,
    },
}

/// Rising times \[s\], each with a measurement or none.
pub(crate) struct Series<'a> {
    times: &'a [f64],
    measurements: &'a [Option<f64>],
    /// Standard deviations of the measurements, where they have their own; none at all, or one per
    /// row.
    stds: &'a [Option<f64>],
}

impl<'a> Series<'a> {
    pub(crate) fn new(
        times: &'a [f64],
        measurements: &'a [Option<f64>],
    ) -> Result<Self, SeriesError> {
        if times.len() != measurements.len() {
            return Err(SeriesError::Length {
                times: times.len(),
                measurements: measurements.len(),
            });
        }
        check_times(times)?;
        check_measurements(measurements)?;
        Ok(Series {
            times,
            measurements,
            stds: &[],
        })
    }

    /// Adds standard deviations of single measurements; none at all, or one per row.
    pub(crate) fn with_stds(self, stds: &'a [Option<f64>]) -> Result<Self, SeriesError> {
        if !stds.is_empty() && stds.len() != self.times.len() {
            return Err(SeriesError::Length {
                times: self.times.len(),
                measurements: stds.len(),
            });
        }
        let wrong = |std: &&f64| !((*std * *std).is_normal() && **std > 0.0);
        match stds.iter().flatten().find(wrong) {
            Some(value) => Err(SeriesError::Parameter {
                name: "standard deviation of a measurement",
                value: *value,
                rule: "> 0",
            }),
            None => Ok(Self { stds, ..self }),
        }
    }

    /// The standard deviation that the measurement of a row has of its own.
    pub(crate) fn std(&self, row: usize) -> Option<f64> {
        self.stds.get(row).copied().flatten()
    }

    /// (row, time, measurement) of every row in order.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, f64, Option<f64>)> {
        self.times
            .iter()
            .zip(self.measurements)
            .enumerate()
            .map(|(row, (&time, &measurement))| (row, time, measurement))
    }

    /// The number of measurements.
    pub(crate) fn measured(&self) -> usize {
        self.measurements.iter().flatten().count()
    }

    /// The median time from row to row; there are at least two rows.
    pub(crate) fn median_step(&self) -> f64 {
        let mut steps: Vec<f64> = self
            .times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        steps.sort_by(f64::total_cmp);
        steps[steps.len() / 2]
    }
}

fn check_times(times: &[f64]) -> Result<(), SeriesError> {
    if let Some(&time) = times.first().filter(|t| !t.is_finite()) {
        return Err(SeriesError::FirstTime { time });
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
    Ok(())
}

fn check_measurements(measurements: &[Option<f64>]) -> Result<(), SeriesError> {
    for (row, measurement) in measurements.iter().enumerate() {
        if let Some(value) = measurement.filter(|value| !value.is_finite()) {
            return Err(SeriesError::Measurement { row, value });
        }
    }
    Ok(())
}
