//! The process noise of a constant-velocity axis by maximum likelihood.

use rayon::prelude::*;

use crate::ConstantVelocity;
use crate::series::{Series, SeriesError};

/// The process noise that makes a series of measurements most probable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoiseFit {
    /// q \[unit²/s³\].
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

impl ConstantVelocity {
    /// The process noise of greatest likelihood; this model's own is not used.
    ///
    /// The search is over ln q within nine decades either side of measurement_std²/h³ (h the median step), where a step's
    /// process noise equals the measurement's: a grid of half-decades, then golden section about its best point. The
    /// result depends on the arguments alone.
    ///
    /// # Errors
    /// If the model or the series is out of range or has fewer than 3 measurements.
    pub fn fit_process_noise(&self, times: &[f64], measurements: &[Option<f64>]) -> Result<ProcessNoiseFit, SeriesError> {
        ConstantVelocity { process_noise: 0.0, ..*self }.check()?;
        let series = Series::new(times, measurements)?;
        let found = series.measured();
        if found < 3 {
            return Err(SeriesError::TooFew { measurements: found });
        }
        let centre = libm::log(self.measurement_std * self.measurement_std) - 3.0 * libm::log(series.median_step());
        let objective = |log_q: f64| self.log_likelihood_at(libm::exp(log_q), &series);
        Ok(search(centre, objective))
    }

    fn log_likelihood_at(&self, process_noise: f64, series: &Series<'_>) -> f64 {
        let mut sum = 0.0;
        let model = ConstantVelocity { process_noise, ..*self };
        model.forward(series, |_, step| sum += step.log_likelihood);
        sum
    }
}

/// Maximises `objective(ln q)` around `centre`.
fn search(centre: f64, objective: impl Fn(f64) -> f64 + Sync) -> ProcessNoiseFit {
    const HALF_DECADE: f64 = std::f64::consts::LN_10 / 2.0;
    const REACH: i32 = 18;
    let at = |i: i32| centre + f64::from(i) * HALF_DECADE;
    let values: Vec<f64> = (-REACH..=REACH).into_par_iter().map(|i| objective(at(i))).collect();
    let (mut best, mut highest) = (-REACH, f64::NEG_INFINITY);
    for (i, value) in (-REACH..).zip(values) {
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
    ProcessNoiseFit { process_noise: libm::exp(log_q), log_likelihood: objective(log_q), optimum }
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
