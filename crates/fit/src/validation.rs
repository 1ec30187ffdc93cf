//! Accuracy of a fit on pushes that it has not seen: [`cross_validate`].

use serde::{Deserialize, Serialize};
use stickslip::{Estimate, Method, NominalPrediction, RunOptions, Setup, quantile, run, wrapped};
use stickslip_dynamics::Pose;
use stickslip_evaluation::{Reference, Scores, score};
use stickslip_filter::{Draw, Streams};
use stickslip_formats::{Experiment, TruthFacts};

use crate::error::FitError;
use crate::fitted::{Fit, FitOptions, fit_prepared, prepare};
use crate::likelihood::{Noise, STRAY_FACTOR, STRAY_SHARE, drift_std, student};
use crate::posterior::Posterior;
use crate::progress::{Listener, Progress};
use crate::push::{PreparedPush, Push};

/// Draws of the noise for each sample of the posterior.
const NOISE_DRAWS: usize = 4;

/// Ends of the predictive interval.
const INTERVAL: [f64; 2] = [0.05, 0.95];

/// Step of the random streams from which on noise is drawn.
const FIRST_NOISE: u64 = 1 << 40;

/// Pushes predicted blind by fits that have not seen them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossValidation {
    /// Parts that the pushes were dealt into, one after the other.
    pub folds: usize,
    /// Each push.
    pub pushes: Vec<HeldOut>,
    /// Medians over the pushes of the final position error (mm): unfitted scene, posterior median.
    pub median_final_mm: [f64; 2],
    /// Medians over the pushes of the WMSE over all rows (mm): unfitted scene, posterior median.
    pub median_wmse_mm: [f64; 2],
    /// Share of final x, y and θ within the 90 % interval predicted for them.
    pub coverage_90: f64,
    /// Gain of the posterior median over the unfitted scene, in the final position error plus the
    /// WMSE (mm): mean over the pushes, and its standard error.
    pub gain_mm: [f64; 2],
    /// True if that mean is above 0. If it is not, a scene keeps its first guesses.
    pub pays: bool,
}

/// One push, predicted from its first pose by a fit to others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Its name.
    pub push: String,
    /// The fold that it is in, from 0.
    pub fold: usize,
    /// Final position error of the unfitted scene, and of the median prediction of the posterior
    /// (mm).
    pub final_mm: [f64; 2],
    /// Predicted minus measured x, y and θ of both at the last measured pose (mm); θ times the
    /// radius of gyration.
    pub final_offset_mm: [[f64; 3]; 2],
    /// Ends of the 90 % interval of each of these three that the posterior gives (mm).
    pub interval_90_mm: [[f64; 2]; 3],
    /// WMSE over all rows of both (mm).
    pub wmse_mm: [f64; 2],
    /// True for each of x, y and θ whose last measured value lies in the 90 % interval predicted
    /// for it.
    pub covered: [bool; 3],
    /// Median prediction of the posterior, row by row of the log; none in a result that was read.
    #[serde(skip)]
    pub poses: Vec<Option<Pose>>,
}

/// Default number of parts that so many pushes are dealt into: 0, none, for fewer than four.
#[must_use]
pub fn default_folds(pushes: usize) -> usize {
    match pushes {
        8.. => 4,
        4..8 => 2,
        _ => 0,
    }
}

/// Deals the pushes into `folds` parts, one after the other, and predicts each part by a fit to the
/// others. Errors are against the measured poses. `progress` gets what was done of how much.
///
/// # Errors
/// Those of [`fit`](crate::fit); a fold that leaves fewer than two pushes to fit.
pub fn cross_validate(
    pushes: &[Push],
    folds: usize,
    options: &FitOptions,
    progress: &Listener<'_>,
) -> Result<CrossValidation, FitError> {
    let most = options.most_vectors();
    let before = |fold: usize| fold as u64 * most;
    let all = before(folds);
    let (prepared, _) = prepare(pushes, &Progress::new(&|_, _| progress(0, all), most))?;
    let least = if folds < 3 { 4 } else { 3.max(folds) };
    if folds < 2 || prepared.len() < least {
        return Err(FitError::TooFewPushes {
            pushes: prepared.len(),
            least,
        });
    }
    let mut held_out: Vec<(usize, HeldOut)> = Vec::new();
    for fold in 0..folds {
        let of_fold = |(k, _): &(usize, &PreparedPush)| k % folds == fold;
        let (test, train): (Vec<_>, Vec<_>) = prepared.iter().enumerate().partition(of_fold);
        let train: Vec<&PreparedPush> = train.into_iter().map(|(_, push)| push).collect();
        let of_fold = |done: u64, _: u64| progress(before(fold) + done, all);
        let of_fold = Progress::new(&of_fold, most);
        let fit = fit_prepared(&train, options, &of_fold)?;
        for (k, push) in test {
            let held = predict_held_out(push, k, fold, &fit, options, &of_fold)?;
            held_out.push((k, held));
        }
    }
    held_out.sort_by_key(|(k, _)| *k);
    let pushes = held_out.into_iter().map(|(_, push)| push).collect();
    Ok(summary(folds, pushes))
}

/// Predicts `pushes` blind by a fit to others, as one fold. Where `validation` of that fit says
/// that fitting does not pay, the fitted scene is the unfitted one; intervals are those of the fit
/// all the same.
///
/// # Errors
/// A push that cannot be simulated, or does not go with the fit.
///
/// # Panics
/// If `fit` was read from a file, which has no samples of the posterior.
pub fn predict(
    pushes: &[Push],
    fit: &Fit,
    validation: Option<&CrossValidation>,
    options: &FitOptions,
) -> Result<CrossValidation, FitError> {
    let refused = validation.is_some_and(|validation| !validation.pays);
    let unseen = Progress::new(&|_, _| (), 0);
    let predicted = pushes.iter().enumerate().map(|(k, push)| {
        let prepared = PreparedPush::new(push.clone())?;
        let mut predicted = predict_held_out(&prepared, k, 0, fit, options, &unseen)?;
        if refused {
            predicted.final_mm[1] = predicted.final_mm[0];
            predicted.final_offset_mm[1] = predicted.final_offset_mm[0];
            predicted.wmse_mm[1] = predicted.wmse_mm[0];
            predicted.poses.clear();
        }
        Ok(predicted)
    });
    Ok(summary(1, predicted.collect::<Result<_, FitError>>()?))
}

fn summary(folds: usize, pushes: Vec<HeldOut>) -> CrossValidation {
    let median = |of: &dyn Fn(&HeldOut) -> f64| {
        let values: Vec<f64> = pushes.iter().map(of).collect();
        quantile(&values, 0.5).unwrap_or(f64::NAN)
    };
    let covered = pushes.iter().flat_map(|push| push.covered);
    let covered = covered.filter(|covered| *covered).count();
    let gains: Vec<f64> = pushes.iter().map(HeldOut::gain_mm).collect();
    let gain_mm = mean_and_error(&gains);
    CrossValidation {
        folds,
        median_final_mm: [0, 1].map(|k| median(&|push| push.final_mm[k])),
        median_wmse_mm: [0, 1].map(|k| median(&|push| push.wmse_mm[k])),
        coverage_90: covered as f64 / (3 * pushes.len()) as f64,
        gain_mm,
        pays: gain_mm[0] > 0.0,
        pushes,
    }
}

impl HeldOut {
    /// Gain of the fitted scene (mm).
    fn gain_mm(&self) -> f64 {
        let [unfitted, fitted] = [0, 1].map(|k| self.final_mm[k] + self.wmse_mm[k]);
        unfitted - fitted
    }
}

/// Mean and its standard error; that of one number is 0.
fn mean_and_error(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, (squares / (n - 1.0).max(1.0) / n).sqrt()]
}

fn predict_held_out(
    push: &PreparedPush,
    index: usize,
    fold: usize,
    fit: &Fit,
    options: &FitOptions,
    progress: &Progress<'_>,
) -> Result<HeldOut, FitError> {
    let posterior = Posterior::new(vec![push], &options.parameters, progress)?;
    let predictions = posterior.predictions(0, &fit.samples).into_iter();
    let predictions = predictions.collect::<Result<Vec<_>, _>>()?;

    let unfitted = &push.push.setup;
    let mut fitted = unfitted.clone();
    fit.apply(&mut fitted)?;
    let mut estimate = nominal_estimate(push, unfitted)?;
    let of_unfitted = scores(push, unfitted, &estimate);
    let unfitted_offset_mm = final_offset_mm(push, &estimate);
    let rows = estimate.rows.iter_mut().skip(push.predictor.first);
    for (row, pose) in rows.zip(median_poses(&predictions)) {
        row.pose = Some(pose);
    }
    let of_fitted = scores(push, &fitted, &estimate);

    let of = |score: fn(&Scores) -> Option<f64>| {
        [&of_unfitted, &of_fitted].map(|scores| score(scores).unwrap_or(f64::NAN))
    };
    let draw = Streams::new(options.seed).at(FIRST_NOISE + index as u64);
    let intervals = intervals(push, &posterior, &fit.samples, &predictions, draw);
    Ok(HeldOut {
        push: push.push.name.clone(),
        fold,
        final_mm: of(|scores| scores.final_error_mm),
        final_offset_mm: [unfitted_offset_mm, final_offset_mm(push, &estimate)],
        wmse_mm: of(|scores| scores.wmse_mm),
        interval_90_mm: intervals.map(|interval| interval.map(|metres| 1e3 * metres)),
        covered: intervals.map(|[low, high]| low <= 0.0 && 0.0 <= high),
        poses: estimate.rows.iter().map(|row| row.pose).collect(),
    })
}

/// The nominal simulation of `setup`.
fn nominal_estimate(push: &PreparedPush, setup: &Setup) -> Result<Estimate, FitError> {
    let options = RunOptions {
        method: Method::Nominal,
        ..RunOptions::default()
    };
    let run =
        run(setup, &push.push.log, &options, &mut |_| ()).map_err(|source| FitError::Run {
            push: push.push.name.clone(),
            source,
        })?;
    Ok(run.estimate)
}

/// Median of several predictions, row by row and axis by axis. A push that may end in two ways has
/// a mean where it never ends.
fn median_poses(predictions: &[NominalPrediction]) -> Vec<Pose> {
    let median = |row: usize| {
        let first = predictions[0].poses[row];
        let of = |axis: &dyn Fn(Pose) -> f64| {
            let poses = predictions.iter().map(|prediction| prediction.poses[row]);
            let values: Vec<f64> = poses.map(axis).collect();
            quantile(&values, 0.5).expect("there are predictions")
        };
        Pose::new(
            of(&|pose| pose.x),
            of(&|pose| pose.y),
            first.theta + of(&|pose| wrapped(pose.theta - first.theta)),
        )
    };
    (0..predictions[0].poses.len()).map(median).collect()
}

/// Estimated minus measured x, y and θ, times the radius of gyration, at the last measured pose
/// (mm).
fn final_offset_mm(push: &PreparedPush, estimate: &Estimate) -> [f64; 3] {
    let (row, measured) = push.measured.last().expect("a prepared push has a pose");
    let estimated = estimate.rows[*row].pose.unwrap_or(*measured);
    let turn = push.push.setup.virtual_radius() * wrapped(estimated.theta - measured.theta);
    let offset = [estimated.x - measured.x, estimated.y - measured.y, turn];
    offset.map(|metres| 1e3 * metres)
}

/// Scores of an estimate against the measured poses, as `setup` understands them.
fn scores(push: &PreparedPush, setup: &Setup, estimate: &Estimate) -> Scores {
    let experiment = Experiment {
        setup: setup.clone(),
        log: push.push.log.clone(),
        truth: None,
        facts: TruthFacts::default(),
    };
    let hidden = vec![false; experiment.log.len()];
    let reference = Reference::measured(&experiment);
    score(estimate, &reference, &hidden, setup.virtual_radius())
}

/// Interval of predicted minus measured x, y and θ, times the radius of gyration (m), of the last
/// measured pose, by the samples, each with its prediction.
fn intervals(
    push: &PreparedPush,
    posterior: &Posterior<'_>,
    samples: &[Vec<f64>],
    predictions: &[NominalPrediction],
    draw: Draw,
) -> [[f64; 2]; 3] {
    let radius = push.push.setup.virtual_radius();
    let mut errors: [Vec<f64>; 3] = Default::default();
    for (sample, (vector, prediction)) in samples.iter().zip(predictions).enumerate() {
        let instants = posterior.instants(0, vector);
        let travelled = instants.last().map_or(0.0, |instant| instant.travelled);
        let residuals = push.residuals(&instants, prediction);
        let last = residuals.last().expect("a prepared push has a pose");
        let noise = posterior.noise(vector);
        for k in 0..NOISE_DRAWS {
            let number = (sample * NOISE_DRAWS + k) as u32;
            let stray = draw.uniform(number, 0) < STRAY_SHARE;
            let drift = if stray { STRAY_FACTOR } else { 1.0 } * noise.drift;
            let noise = Noise { drift, ..noise };
            let stds = drift_std(travelled, &noise, push.noise(), radius);
            for axis in 0..3 {
                let camera = push.noise()[axis / 2] * noise.camera_scale;
                let first = 2 + 16 * axis as u32;
                let drifted = stds[axis] * draw.normal(number, first);
                let measured = camera * student(draw, number, first + 2);
                errors[axis].push(drifted + measured - last[axis]);
            }
        }
    }
    errors.map(|errors| INTERVAL.map(|q| quantile(&errors, q).expect("there are samples")))
}
