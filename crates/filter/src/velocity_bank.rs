//! One axis whose liveliness is not known and changes: several constant-velocity filters of
//! different process noise that interact.
//!
//! The interacting multiple model filter (Blom & Bar-Shalom 1988; Bar-Shalom, Li & Kirubarajan
//! 2001, section 11.6.6). Between two rows h apart a mode lasts with probability exp(−h/dwell),
//! else it changes to any other one with equal probability. Each row:
//!
//! | | |
//! | --- | --- |
//! | interact | c_j = Σ_i p_ij w_i; mode j starts from the mixture of all modes' states with weights p_ij w_i / c_j, as one normal |
//! | filter | each mode predicts and updates with its own process noise; Λ_j is its likelihood of the measurement |
//! | weigh | w_j ∝ Λ_j c_j |
//!
//! The estimate is the mixture's mean and variance. Every row is a function of the rows up to it.

use nalgebra::Vector2;

use crate::series::{Series, SeriesError};
use crate::{AxisEstimate, ConstantVelocity, Filtered, Gaussian};

/// Constant-velocity models of one axis, any of which may hold at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityBank {
    /// The modes, at least one.
    pub modes: Vec<ConstantVelocity>,
    /// Mean time for which one mode holds (s), > 0; infinite where the mode is unknown but never
    /// changes.
    pub dwell: f64,
}

/// What is known of the axis at one row: each mode's weight and state.
#[derive(Clone, Debug, PartialEq)]
pub struct BankState {
    modes: Vec<(f64, Gaussian<2>)>,
}

impl VelocityBank {
    /// The state at a first measurement: all modes alike.
    #[must_use]
    pub fn start(&self, position: f64) -> BankState {
        let weight = 1.0 / self.modes.len() as f64;
        BankState {
            modes: self
                .modes
                .iter()
                .map(|mode| (weight, mode.start(position)))
                .collect(),
        }
    }

    /// The state `h` (s) later given a measurement there, if there is one, and ln p(measurement |
    /// before), 0 without.
    #[must_use]
    pub fn step(&self, state: &BankState, h: f64, measurement: Option<f64>) -> (BankState, f64) {
        let interacted = self.interact(state, h);
        let predicted = interacted
            .into_iter()
            .zip(&self.modes)
            .map(|((weight, state), mode)| (weight, mode.predict(&state, h), mode));
        let Some(position) = measurement else {
            return (
                BankState {
                    modes: predicted
                        .map(|(weight, state, _)| (weight, state))
                        .collect(),
                },
                0.0,
            );
        };
        let updated: Vec<(f64, Gaussian<2>)> = predicted
            .map(|(weight, state, mode)| {
                let (state, log_likelihood) = mode.update(&state, position);
                (libm::log(weight) + log_likelihood, state)
            })
            .collect();
        let best = updated
            .iter()
            .map(|(log_weight, _)| *log_weight)
            .fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = updated
            .iter()
            .map(|(log_weight, _)| libm::exp(log_weight - best))
            .sum();
        let modes = updated
            .into_iter()
            .map(|(log_weight, state)| (libm::exp(log_weight - best) / sum, state));
        (
            BankState {
                modes: modes.collect(),
            },
            best + libm::log(sum),
        )
    }

    /// Each mode's weight c_j and state after modes may have changed.
    fn interact(&self, state: &BankState, h: f64) -> Vec<(f64, Gaussian<2>)> {
        let count = state.modes.len();
        let stay = if count == 1 {
            1.0
        } else {
            libm::exp(-h / self.dwell)
        };
        let change = if count == 1 {
            0.0
        } else {
            (1.0 - stay) / (count - 1) as f64
        };
        let into = |j: usize| {
            let from = |i: usize| if i == j { stay } else { change };
            let parts: Vec<(f64, Gaussian<2>)> = state
                .modes
                .iter()
                .enumerate()
                .map(|(i, (w, s))| (from(i) * w, *s))
                .collect();
            let weight: f64 = parts.iter().map(|(w, _)| w).sum();
            // a mode that nothing leads to keeps its state
            if weight > 0.0 {
                (weight, mixture(&parts, weight))
            } else {
                (0.0, state.modes[j].1)
            }
        };
        (0..count).map(into).collect()
    }

    /// The filter over a series: `times` (s) rise, a measurement may be missing; missing rows are
    /// extrapolated.
    ///
    /// ```
    /// # use stickslip_filter::{ConstantVelocity, VelocityBank};
    /// let mode = |process_noise| ConstantVelocity { process_noise, measurement_std: 1e-4, initial_velocity_std: 0.1 };
    /// let bank = VelocityBank { modes: vec![mode(1e-9), mode(1e-4)], dwell: 30.0 };
    /// let rows = bank.filter(&[0.0, 0.1, 0.2, 0.3], &[Some(0.0), Some(0.01), Some(0.02), None])?.rows;
    /// assert!((rows[3].unwrap().position - 0.03).abs() < 1e-4);
    /// # Ok::<(), stickslip_filter::SeriesError>(())
    /// ```
    ///
    /// # Errors
    /// If a mode, the dwell time or the series is out of range, or there is no mode.
    pub fn filter(
        &self,
        times: &[f64],
        measurements: &[Option<f64>],
    ) -> Result<Filtered, SeriesError> {
        self.check()?;
        let series = Series::new(times, measurements)?;
        let mut filtered = Filtered {
            rows: vec![None; times.len()],
            log_likelihood: 0.0,
        };
        let mut before: Option<(f64, BankState)> = None;
        for (row, time, measurement) in series.rows() {
            let (state, log_likelihood) = match (before.take(), measurement) {
                (Some((then, state)), _) => self.step(&state, time - then, measurement),
                (None, Some(position)) => (self.start(position), 0.0),
                (None, None) => continue,
            };
            filtered.rows[row] = Some(state.estimate());
            filtered.log_likelihood += log_likelihood;
            before = Some((time, state));
        }
        Ok(filtered)
    }

    fn check(&self) -> Result<(), SeriesError> {
        self.modes.iter().try_for_each(ConstantVelocity::check)?;
        let refused = |name, value, rule| Err(SeriesError::Parameter { name, value, rule });
        match (self.modes.len(), self.dwell) {
            (0, _) => refused("modes", 0.0, "at least 1"),
            (_, dwell) if dwell.is_nan() || dwell <= 0.0 => refused("dwell", dwell, "> 0"),
            _ => Ok(()),
        }
    }
}

impl BankState {
    /// Mean and variance over the modes.
    #[must_use]
    pub fn estimate(&self) -> AxisEstimate {
        AxisEstimate::from(mixture(&self.modes, 1.0))
    }

    /// Probability of each mode.
    pub fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        self.modes.iter().map(|(weight, _)| *weight)
    }
}

/// The normal distribution with the mean and the covariance of a mixture whose weights sum to
/// `total`.
fn mixture(parts: &[(f64, Gaussian<2>)], total: f64) -> Gaussian<2> {
    let mean: Vector2<f64> = parts
        .iter()
        .map(|(weight, state)| state.mean * (weight / total))
        .sum();
    let about = |state: &Gaussian<2>| {
        state.covariance + (state.mean - mean) * (state.mean - mean).transpose()
    };
    Gaussian {
        mean,
        covariance: parts
            .iter()
            .map(|(weight, state)| about(state) * (weight / total))
            .sum(),
    }
}
