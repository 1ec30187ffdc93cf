//! Posterior of a vector of parameters after some pushes: [`Posterior`].
//!
//! A vector has a whitened coordinate for each free parameter, then one for the camera's noise and
//! one for the model's drift; all are standard normal before any push.

use std::borrow::Cow;

use rayon::prelude::*;
use stickslip::{NominalPrediction, Surface};
use stickslip_dynamics::ShapeError;

use crate::coarsening::power;
use crate::error::FitError;
use crate::likelihood::{Noise, log_likelihood};
use crate::parameter::Parameter;
use crate::prior::Prior;
use crate::progress::Progress;
use crate::push::{Instant, PreparedPush};

/// Vectors whose pushes are predicted side by side.
const LANES: usize = 8;

/// Numbers of a vector that are no parameters.
pub(crate) const NUISANCES: usize = 2;

/// Prior of the factor of the camera's noise.
const CAMERA_SCALE: Prior = Prior::LogNormal {
    median: 1.0,
    relative_std: 0.7,
};

/// Prior of the drift (m/m).
const DRIFT: Prior = Prior::LogNormal {
    median: 0.03,
    relative_std: 1.5,
};

/// The pushes and the free parameters.
pub(crate) struct Posterior<'a> {
    progress: &'a Progress<'a>,
    pub pushes: Vec<&'a PreparedPush>,
    /// Times at which the poses of each push were taken.
    instants: Vec<Vec<Instant>>,
    /// True if all vectors have one scene, but for friction.
    side_by_side: bool,
    pub parameters: Vec<(Parameter, Prior)>,
}

impl<'a> Posterior<'a> {
    /// # Errors
    /// The scenes do not go together, or leave nothing open.
    pub fn new(
        pushes: Vec<&'a PreparedPush>,
        parameters: &[Parameter],
        progress: &'a Progress<'a>,
    ) -> Result<Self, FitError> {
        let first = *pushes.first().ok_or(FitError::TooFewPushes {
            pushes: 0,
            least: 1,
        })?;
        for parameter in parameters {
            for push in &pushes {
                check(*parameter, first, push)?;
            }
        }
        let prior = |parameter: &Parameter| (*parameter, parameter.prior(&first.push.setup));
        Ok(Self {
            progress,
            parameters: parameters.iter().map(prior).collect(),
            side_by_side: parameters.iter().all(|parameter| parameter.keeps_scene()),
            instants: pushes
                .iter()
                .map(|push| push.instants(push.latency()))
                .collect(),
            pushes,
        })
    }

    /// Power of the likelihood that the drift of a vector deserves.
    pub fn power(&self, vector: &[f64]) -> f64 {
        power(self.pushes.len(), self.noise(vector).drift)
    }

    /// Numbers of a vector.
    pub fn dimension(&self) -> usize {
        self.parameters.len() + NUISANCES
    }

    /// Returns true if vectors have scenes of their own, so that their predictions do not run side
    /// by side.
    pub fn is_costly(&self) -> bool {
        !self.side_by_side
    }

    /// The noise that a vector stands for.
    pub fn noise(&self, vector: &[f64]) -> Noise {
        noise_of(&vector[self.parameters.len()..])
    }

    /// Log-likelihood of each vector, up to a constant; a vector far out of range has -∞.
    pub fn log_likelihoods(&self, vectors: &[Vec<f64>]) -> Vec<f64> {
        let chunks: Vec<&[Vec<f64>]> = vectors.chunks(LANES).collect();
        let pushes = self.pushes.len();
        self.progress.add(vectors.len());
        let jobs = (0..chunks.len() * pushes).into_par_iter();
        let of_pushes: Vec<[f64; LANES]> = jobs
            .map(|job| self.of_push(job % pushes, chunks[job / pushes]))
            .collect();
        let likelihood = |i: usize| {
            let of_pushes = &of_pushes[i / LANES * pushes..][..pushes];
            of_pushes.iter().map(|lanes| lanes[i % LANES]).sum()
        };
        (0..vectors.len()).map(likelihood).collect()
    }

    /// Predictions of one push by each vector; an outline that is none has no prediction.
    pub fn predictions(
        &self,
        push: usize,
        vectors: &[Vec<f64>],
    ) -> Vec<Result<NominalPrediction, ShapeError>> {
        self.progress.show();
        let prepared = self.pushes[push];
        let setup = |vector: &Vec<f64>| {
            let mut setup = prepared.push.setup.clone();
            Parameter::apply(&self.values(vector), &mut setup)?;
            Ok(setup.scene)
        };
        let in_scene = |vector: &Vec<f64>| {
            let scene = setup(vector)?;
            let friction = scene.nominal;
            let mut predictions = prepared
                .predictor
                .with_scene(scene)
                .predict(&[friction.into()]);
            Ok(predictions.remove(0))
        };
        if !self.side_by_side {
            return vectors.iter().map(in_scene).collect();
        }
        let nominal = prepared.push.setup.scene.nominal;
        let surface = |vector: &Vec<f64>| Parameter::surface(&self.values(vector), nominal);
        let surfaces: Vec<Surface> = vectors.iter().map(surface).collect();
        let predictions = prepared.predictor.predict(&surfaces);
        predictions.into_iter().map(Ok).collect()
    }

    /// Times at which the poses of a push were taken, by the latency of a vector.
    pub fn instants(&self, push: usize, vector: &[f64]) -> Cow<'_, [Instant]> {
        let mut values = self.values(vector).into_iter();
        match values.find(|(parameter, _)| *parameter == Parameter::Latency) {
            Some((_, latency)) => Cow::Owned(self.pushes[push].instants(latency.max(0.0))),
            None => Cow::Borrowed(&self.instants[push]),
        }
    }

    fn values(&self, vector: &[f64]) -> Vec<(Parameter, f64)> {
        let values = self.parameters.iter().zip(vector);
        values
            .map(|((parameter, prior), z)| (*parameter, prior.value(*z)))
            .collect()
    }

    /// Log-likelihoods of one push by a few vectors.
    fn of_push(&self, push: usize, vectors: &[Vec<f64>]) -> [f64; LANES] {
        let prepared = self.pushes[push];
        let radius = prepared.push.setup.virtual_radius();
        let mut likelihoods = [f64::NEG_INFINITY; LANES];
        let predictions = self.predictions(push, vectors);
        for ((likelihood, prediction), vector) in
            likelihoods.iter_mut().zip(&predictions).zip(vectors)
        {
            let Ok(prediction) = prediction else {
                continue;
            };
            let instants = self.instants(push, vector);
            let travelled: Vec<f64> = instants.iter().map(|instant| instant.travelled).collect();
            *likelihood = log_likelihood(
                &prepared.residuals(&instants, prediction),
                &travelled,
                &self.noise(vector),
                prepared.noise(),
                radius,
            );
        }
        likelihoods
    }
}

/// The noise that the last numbers of a vector stand for.
pub(crate) fn noise_of(nuisances: &[f64]) -> Noise {
    Noise {
        camera_scale: CAMERA_SCALE.value(nuisances[0]),
        drift: DRIFT.value(nuisances[1]),
    }
}

/// Refuses a parameter that `push` does not have, has no open prior for, or another one than
/// `first`.
fn check(parameter: Parameter, first: &PreparedPush, push: &PreparedPush) -> Result<(), FitError> {
    let (name, prior) = (push.push.name.clone(), parameter.prior(&push.push.setup));
    if parameter.is_of_support() && !push.push.setup.has_tripod() {
        return Err(FitError::KnownFeet {
            push: name,
            parameter: parameter.name(),
        });
    }
    if parameter == Parameter::Latency && push.push.setup.camera.is_none() {
        return Err(FitError::NoCamera { push: name });
    }
    let (value, spread) = prior.guess();
    if !prior.is_open() {
        return Err(FitError::ClosedPrior {
            push: name,
            parameter: parameter.name(),
            value,
            spread,
        });
    }
    let of_first = parameter.prior(&first.push.setup);
    if of_first != prior {
        let (a, a_spread) = of_first.guess();
        return Err(FitError::Disagree {
            parameter: parameter.name(),
            first: first.push.name.clone(),
            a,
            a_spread,
            second: name,
            b: value,
            b_spread: spread,
        });
    }
    Ok(())
}
