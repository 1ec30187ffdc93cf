//! Learns parameters that a scene cannot know from many pushes: [`fit`].
//!
//! A vector of parameters is judged by how well it predicts every push blind, from the first pose
//! of the object and the recorded pusher alone. Several populations that cool from the prior sample
//! the posterior; [`cross_validate`] gives the accuracy of the fit on pushes that it has not seen.

#[cfg(test)]
mod calibration;
mod chain;
mod coarsening;
mod doubts;
mod error;
mod fitted;
mod likelihood;
mod parameter;
mod posterior;
mod prior;
mod progress;
mod push;
mod sampler;
mod scene_text;
mod validation;

pub use doubts::doubts;
pub use error::FitError;
pub use fitted::{Agreement, Fit, FitOptions, FittedParameter, Sampling, fit};
pub use likelihood::Noise;
pub use parameter::Parameter;
pub use prior::Prior;
pub use progress::Listener;
pub use push::{Push, by_object};
pub use validation::{CrossValidation, HeldOut, cross_validate, default_folds, predict};
