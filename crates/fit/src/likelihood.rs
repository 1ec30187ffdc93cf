//! Likelihood of measured poses, given a prediction: [`Noise`] and [`log_likelihood`].
//!
//! A prediction errs for two reasons. The camera adds noise to every pose, independent from row to
//! row. The model drifts away from the truth on the way: its error grows by a share of the way that
//! the pusher goes. That share decorrelates over about one radius of gyration (an
//! Ornstein–Uhlenbeck process over the way). Both are estimated, since neither is known in advance.
//! A model without drift would take a hundred rows of one push for a hundred independent witnesses.
//!
//! Per axis (x, y and the angle times the radius of gyration) that is a linear-Gaussian state of
//! two numbers, drift and its rate, so a Kalman filter gives the likelihood in one pass.
//! Innovations are taken for Student-t, for frames that are off; a tenth of the pushes may drift
//! four times as much.

use serde::{Deserialize, Serialize};
use stickslip_filter::Draw;

/// Degrees of freedom of innovations.
const FREEDOM: f64 = 5.0;

/// Share of pushes that drift more than the others.
pub(crate) const STRAY_SHARE: f64 = 0.1;

/// Factor by which these drift more.
pub(crate) const STRAY_FACTOR: f64 = 4.0;

/// Parts of the memory length that one step of the filter may cover.
const STEPS_PER_MEMORY: f64 = 4.0;

/// Deviation of measured poses from predicted ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Factor of the camera's standard deviations in the scene.
    pub camera_scale: f64,
    /// Standard deviation of the prediction's error per way of the pusher (m/m).
    pub drift: f64,
}

/// The noise of one axis of one push.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Variance of a measurement (m²).
    measured: f64,
    /// Variance of the drift's rate (m²/m²).
    rate: f64,
    /// Way over which the rate forgets itself (m).
    memory: f64,
}

/// Drift and its rate: means, and the covariance (dd, da, aa).
#[derive(Clone, Copy, Debug)]
struct State {
    mean: [f64; 2],
    covariance: [f64; 3],
}

impl Axis {
    /// At the first pose, whose own error shifts the whole prediction.
    fn start(&self) -> State {
        State {
            mean: [0.0; 2],
            covariance: [self.measured, 0.0, self.rate],
        }
    }

    /// After `way` (m) more.
    fn advance(&self, state: &mut State, way: f64) {
        if way <= 0.0 {
            return;
        }
        let steps = (STEPS_PER_MEMORY * way / self.memory).ceil().max(1.0);
        let (way, kept) = (way / steps, libm::exp(-way / steps / self.memory));
        for _ in 0..steps as usize {
            let [d, a] = state.mean;
            let [dd, da, aa] = state.covariance;
            state.mean = [d + way * a, kept * a];
            state.covariance = [
                dd + way * (2.0 * da + way * aa),
                kept * (da + way * aa),
                kept * kept * aa + (1.0 - kept * kept) * self.rate,
            ];
        }
    }

    /// Log-likelihood of a residual (m), up to a constant; the state learns from it.
    fn observe(&self, state: &mut State, residual: f64) -> f64 {
        let [dd, da, aa] = state.covariance;
        let variance = dd + self.measured;
        let innovation = residual - state.mean[0];
        let [gain, rate_gain] = [dd / variance, da / variance];
        state.mean[0] += gain * innovation;
        state.mean[1] += rate_gain * innovation;
        state.covariance = [dd - gain * dd, da - gain * da, aa - rate_gain * da];
        let square = innovation * innovation / variance;
        -0.5 * (libm::log(variance) + (FREEDOM + 1.0) * libm::log1p(square / FREEDOM))
    }
}

/// Noise of the three axes of a push: `camera` has the standard deviations that its scene gives
/// (m), `memory` is the way over which drift forgets itself (m).
fn axes(noise: &Noise, camera: [f64; 2], memory: f64) -> [Axis; 3] {
    let [position, angle] = camera.map(|std| noise.camera_scale * std);
    [position, position, angle].map(|std| Axis {
        measured: std * std,
        rate: noise.drift * noise.drift,
        memory,
    })
}

/// Log-likelihood of the residuals of one push, up to a constant: measured minus predicted poses
/// (m, m, and angles times the radius of gyration), each after `travelled` of the pusher (m).
pub(crate) fn log_likelihood(
    residuals: &[[f64; 3]],
    travelled: &[f64],
    noise: &Noise,
    camera: [f64; 2],
    memory: f64,
) -> f64 {
    let of = |noise: &Noise| {
        let mut sum = 0.0;
        for (k, axis) in axes(noise, camera, memory).iter().enumerate() {
            let mut state = axis.start();
            let mut before = 0.0;
            for (residual, way) in residuals.iter().zip(travelled) {
                axis.advance(&mut state, way - before);
                before = *way;
                sum += axis.observe(&mut state, residual[k]);
            }
        }
        sum
    };
    let plain = of(noise) + libm::log(1.0 - STRAY_SHARE);
    let stray = Noise {
        drift: STRAY_FACTOR * noise.drift,
        ..*noise
    };
    let stray = of(&stray) + libm::log(STRAY_SHARE);
    let most = plain.max(stray);
    most + libm::log1p(libm::exp(plain.min(stray) - most))
}

/// Residuals of one push, drawn from this likelihood: [`log_likelihood`] is their density.
#[cfg(test)]
pub(crate) fn drawn_residuals(
    travelled: &[f64],
    noise: &Noise,
    camera: [f64; 2],
    memory: f64,
    draw: Draw,
) -> Vec<[f64; 3]> {
    let stray = draw.uniform(0, 0) < STRAY_SHARE;
    let noise = Noise {
        drift: if stray { STRAY_FACTOR } else { 1.0 } * noise.drift,
        ..*noise
    };
    let mut residuals = vec![[0.0; 3]; travelled.len()];
    for (k, axis) in axes(&noise, camera, memory).iter().enumerate() {
        let (mut state, mut before) = (axis.start(), 0.0);
        for (row, (way, residual)) in travelled.iter().zip(&mut residuals).enumerate() {
            axis.advance(&mut state, way - before);
            before = *way;
            let spread = (state.covariance[0] + axis.measured).sqrt();
            let first = 1 + 16 * k as u32;
            residual[k] = state.mean[0] + spread * student(draw, 1 + row as u32, first);
            axis.observe(&mut state, residual[k]);
        }
    }
    residuals
}

/// A number of Student's t distribution with [`FREEDOM`] degrees of freedom.
pub(crate) fn student(draw: Draw, number: u32, first: u32) -> f64 {
    let degrees = FREEDOM as u32;
    let squares = (1..=degrees).map(|k| draw.normal(number, first + k));
    let chi_squared: f64 = squares.map(|x| x * x).sum();
    draw.normal(number, first) / (chi_squared / FREEDOM).sqrt()
}

/// Standard deviations of how far each axis of a prediction (m) has drifted after `travelled` (m),
/// the first pose's own error included.
pub(crate) fn drift_std(travelled: f64, noise: &Noise, camera: [f64; 2], memory: f64) -> [f64; 3] {
    axes(noise, camera, memory).map(|axis| {
        let mut state = axis.start();
        axis.advance(&mut state, travelled);
        state.covariance[0].sqrt()
    })
}
