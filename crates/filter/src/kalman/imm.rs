//! One axis whose process noise is unknown and changes: the interacting multiple model filter
//! (Blom & Bar-Shalom 1988; Bar-Shalom, Li & Kirubarajan 2001, section 11.6.6).
//!
//! Each mode is a [`ConstantVelocity`] model with a process noise of its own; which mode holds is a
//! Markov chain. Over a step h a mode stays with probability exp(−h / mean sojourn time), and
//! otherwise changes to any other one with equal probability. Each row:
//!
//! | | |
//! | --- | --- |
//! | interact | c_j = Σ_i p_ij w_i; mode j starts from the normal distribution with the moments of the mixture of all modes' states, weights p_ij w_i / c_j |
//! | filter | each mode predicts and updates with its own process noise; Λ_j is its likelihood of the measurement |
//! | weigh | w_j ∝ Λ_j c_j |
//!
//! The estimate is the mixture's mean and variance. Every row is a function of the rows up to it.

use std::array::from_fn;

use crate::kalman::constant_velocity::{AxisEstimate, ConstantVelocity, Filtered};
use crate::kalman::gaussian::Gaussian;
use crate::kalman::series::{Series, SeriesError};

/// Constant-velocity models of one axis, one of which holds at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteractingMultipleModel<const M: usize> {
    /// The modes, at least one.
    pub modes: [ConstantVelocity; M],
    /// Mean time that the axis stays in a mode \[s\], > 0; infinite where the mode is unknown but
    /// never changes.
    pub mean_sojourn_time: f64,
}

/// The state at one row: (probability, state) of every mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImmState<const M: usize> {
    modes: [(f64, Gaussian<2>); M],
}

impl<const M: usize> InteractingMultipleModel<M> {
    /// The state at a first measurement: all modes equally probable.
    #[must_use]
    pub fn start(&self, position: f64) -> ImmState<M> {
        let probability = 1.0 / M as f64;
        ImmState {
            modes: self.modes.map(|mode| (probability, mode.start(position))),
        }
    }

    /// The state `h` \[s\] later, given the measurement there if there is one, and
    /// ln p(measurement | rows before), 0 without one.
    #[must_use]
    pub fn step(
        &self,
        state: &ImmState<M>,
        h: f64,
        measurement: Option<f64>,
    ) -> (ImmState<M>, f64) {
        // interact
        let mut modes = self.interact(state, h);

        // filter: the probabilities become unnormalised log-probabilities ln Λ_j c_j
        for ((_, state), model) in modes.iter_mut().zip(&self.modes) {
            *state = model.predict(state, h);
        }
        let Some(position) = measurement else {
            return (ImmState { modes }, 0.0);
        };
        for ((weight, state), model) in modes.iter_mut().zip(&self.modes) {
            let (posterior, log_likelihood) = model.update(state, position);
            *state = posterior;
            *weight = libm::log(*weight) + log_likelihood;
        }

        // weigh: relative to the largest, which cannot overflow
        let largest = modes
            .iter()
            .fold(f64::NEG_INFINITY, |largest, mode| largest.max(mode.0));
        for (weight, _) in &mut modes {
            *weight = libm::exp(*weight - largest);
        }
        let sum: f64 = modes.iter().map(|(weight, _)| weight).sum();
        for (weight, _) in &mut modes {
            *weight /= sum;
        }
        (ImmState { modes }, largest + libm::log(sum))
    }

    /// Probability c_j and state of each mode after the mode may have changed.
    fn interact(&self, state: &ImmState<M>, h: f64) -> [(f64, Gaussian<2>); M] {
        let (stay, change) = if M == 1 {
            (1.0, 0.0)
        } else {
            let stay = libm::exp(-h / self.mean_sojourn_time);
            (stay, (1.0 - stay) / (M - 1) as f64)
        };
        let into = |j: usize| {
            let transition = |i: usize| if i == j { stay } else { change };
            let parts: [(f64, Gaussian<2>); M] = from_fn(|i| {
                let (weight, state) = state.modes[i];
                (transition(i) * weight, state)
            });
            let weight: f64 = parts.iter().map(|(weight, _)| weight).sum();
            // a mode of probability 0 keeps its state
            if weight > 0.0 {
                (weight, Gaussian::mixture(&parts, weight))
            } else {
                (0.0, state.modes[j].1)
            }
        };
        from_fn(into)
    }

    /// The filter over a series: `times` \[s\] rise, a measurement may be missing; missing rows are
    /// extrapolated.
    ///
    /// ```
    /// # use stickslip_filter::{ConstantVelocity, InteractingMultipleModel};
    /// let mode = |process_noise| ConstantVelocity { process_noise, measurement_std: 1e-4, initial_velocity_std: 0.1 };
    /// let imm = InteractingMultipleModel { modes: [mode(1e-9), mode(1e-4)], mean_sojourn_time: 30.0 };
    /// let rows = imm.filter(&[0.0, 0.1, 0.2, 0.3], &[Some(0.0), Some(0.01), Some(0.02), None])?.rows;
    /// assert!((rows[3].unwrap().position - 0.03).abs() < 1e-4);
    /// # Ok::<(), stickslip_filter::SeriesError>(())
    /// ```
    ///
    /// # Errors
    /// If a mode, the mean sojourn time or the series is out of range, or there is no mode.
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
        let mut before: Option<(f64, ImmState<M>)> = None;
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

    /// Refuses parameters out of range.
    ///
    /// # Errors
    /// If a mode or the mean sojourn time is out of range, or there is no mode.
    pub fn check(&self) -> Result<(), SeriesError> {
        self.modes.iter().try_for_each(ConstantVelocity::check)?;
        let refused = |name, value, rule| Err(SeriesError::Parameter { name, value, rule });
        match (M, self.mean_sojourn_time) {
            (0, _) => refused("modes", 0.0, "at least 1"),
            (_, time) if time.is_nan() || time <= 0.0 => refused("mean_sojourn_time", time, "> 0"),
            _ => Ok(()),
        }
    }
}

impl<const M: usize> ImmState<M> {
    /// Mean and variance over the modes.
    #[must_use]
    pub fn estimate(&self) -> AxisEstimate {
        AxisEstimate::from(Gaussian::mixture(&self.modes, 1.0))
    }
}
