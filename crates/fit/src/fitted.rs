//! Fit of parameters to pushes: [`fit`].

use serde::Serialize;
use stickslip::Setup;
use stickslip_dynamics::ShapeError;
use stickslip_filter::Streams;

use crate::chain::Chain;
use crate::discrepancy::{Constant, is_known};
use crate::error::FitError;
use crate::likelihood::Noise;
use crate::optimum::{most_tried, optima};
use crate::parameter::Parameter;
use crate::posterior::{NUISANCES, Posterior, noise_of};
use crate::prior::Prior;
use crate::progress::{Listener, Progress};
use crate::push::{PreparedPush, Push};
use crate::sampler::{most_sampled, rounds, sample};

/// Posterior over prior standard deviation below which a parameter counts as determined.
const DETERMINED: f64 = 0.5;

/// Posterior over prior standard deviation up to which a parameter takes the value that predicts
/// best. Above, the pushes say next to nothing, and it keeps its first guess.
const LEARNT: f64 = 0.8;

/// Vectors drawn from the prior, the best of which start searches.
const SCREENED: usize = 256;

/// Searches for the optimum.
const SEARCHES: usize = 4;

/// Split R̂ above which the chains have not settled (Vehtari et al. 2021).
const SETTLED: f64 = 1.01;

/// Samples that stand for the posterior.
const KEPT_SAMPLES: usize = 512;

/// Parameters to learn, and the random numbers to use.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Result of a fit to some pushes.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// Number of pushes.
    pub pushes: usize,
    /// The free parameters.
    pub parameters: Vec<FittedParameter>,
    /// Their posterior correlation, row by row.
    pub correlation: Vec<Vec<f64>>,
    /// Deviation of measured poses from predicted ones.
    pub noise: Noise,
    /// Facts about the exploration of the posterior.
    pub sampling: Sampling,
    /// Samples of the posterior, as [`Posterior`] takes them.
    #[serde(skip)]
    pub(crate) samples: Vec<Vec<f64>>,
}

/// A parameter before and after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Its name.
    pub name: &'static str,
    /// The parameter.
    #[serde(skip)]
    pub parameter: Parameter,
    /// Symbol of its unit; empty for a bare number.
    pub unit: &'static str,
    /// The value that predicts best; the prior's centre where nothing was learnt of it.
    pub value: f64,
    /// Standard deviation; that of the prior where nothing was learnt of it.
    pub std: f64,
    /// Its prior.
    pub prior: Prior,
    /// Its centre, in the parameter's unit.
    pub prior_value: f64,
    /// Its standard deviation, at its centre.
    pub prior_std: f64,
    /// Posterior over prior standard deviation: 0 where the pushes say all, 1 where they say
    /// nothing.
    pub std_ratio: f64,
    /// True if `std_ratio` is below 0.5.
    pub determined: bool,
    /// True if it is below 0.8, and `value` the fit's.
    pub learnt: bool,
    /// Constant of the rig, which `value` imitates. It is known of `mu_p` and `tripod_radius` if
    /// both are free, and besides them at most `mu_s` and `mu_f`. For other fits the difference
    /// between both is unknown.
    pub constant: Option<Constant>,
}

/// Facts about the exploration of the posterior.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sampling {
    /// Vectors of parameters with which all pushes were predicted.
    pub vectors: u64,
    /// Share of the chains' proposals that were accepted.
    pub acceptance: f64,
    /// Largest split R̂ of the parameters and the noise.
    pub split_rhat: f64,
    /// Independent samples that the chains are worth, of the parameter or noise with the fewest.
    pub effective_samples: f64,
    /// True if the chains agree (R̂ up to 1.01). Otherwise spreads are not known, and
    /// [`Fit::scene_text`] leaves those of the scene.
    pub settled: bool,
    /// Steps without a certified solution in the predictions with the fitted values.
    pub unsolved: u32,
}

/// Learns the free parameters of `options` from `pushes`; `progress` gets what was done of how
/// much.
///
/// # Errors
/// Fewer than two pushes, scenes that do not go together, or a push that cannot be simulated.
pub fn fit(
    pushes: &[Push],
    options: &FitOptions,
    progress: &Listener<'_>,
) -> Result<Fit, FitError> {
    let progress = Progress::new(progress, options.most_vectors());
    let prepared = prepare(pushes, &progress)?;
    fit_prepared(&prepared.iter().collect::<Vec<_>>(), options, &progress)
}

/// Pushes made ready; at least two.
pub(crate) fn prepare(
    pushes: &[Push],
    progress: &Progress<'_>,
) -> Result<Vec<PreparedPush>, FitError> {
    if pushes.len() < 2 {
        return Err(FitError::TooFewPushes {
            pushes: pushes.len(),
            least: 2,
        });
    }
    let prepared = pushes.iter().cloned().map(|push| {
        progress.show();
        PreparedPush::new(push)
    });
    prepared.collect()
}

impl FitOptions {
    /// Upper limit of the number of vectors that a fit tries; a search rarely exceeds its share.
    pub(crate) fn most_vectors(&self) -> u64 {
        let dimension = self.parameters.len() + NUISANCES;
        let costly = !self.parameters.iter().all(|free| free.keeps_scene());
        let searches = (SEARCHES + 1) as u64 * most_tried(dimension);
        SCREENED as u64 + searches + most_sampled(dimension, rounds(costly))
    }
}

pub(crate) fn fit_prepared<'a>(
    pushes: &[&'a PreparedPush],
    options: &FitOptions,
    progress: &'a Progress<'a>,
) -> Result<Fit, FitError> {
    let posterior = Posterior::new(pushes.to_vec(), &options.parameters, progress)?;
    let streams = Streams::new(options.seed);

    // the optimum, from the best of many draws from the prior
    let (starts, screened) = screen(&posterior, streams);
    let (best, searched) = optima(&posterior, &starts);
    let optimum = &best[0];

    // the posterior around it
    let (chain, sampled) = sample(&posterior, optimum, SETTLED, streams);
    let covariance = chain.covariance();
    let free = options.parameters.len();
    let stds: Vec<f64> = (0..free).map(|k| covariance[k][k].sqrt()).collect();

    // what nothing was learnt of keeps its prior, and the others go with that
    let (values, noise, refined) = settle(options, &posterior, optimum, &stds)?;

    let parameters = posterior.parameters.iter().zip(&values).zip(&stds);
    let fit = Fit {
        pushes: pushes.len(),
        parameters: parameters
            .map(|((&(parameter, prior), &z), &std)| {
                let constant = Constant::behind(parameter, &prior, [z, std], noise.drift);
                let constant = constant.filter(|_| is_known(&options.parameters));
                FittedParameter {
                    constant,
                    ..fitted(parameter, prior, [z, std])
                }
            })
            .collect(),
        correlation: correlation(&covariance, free),
        noise,
        sampling: sampling(&chain, screened + searched + sampled + refined),
        samples: chain.thinned(KEPT_SAMPLES),
    };
    Ok(fit.with_unsolved(&posterior, &values))
}

/// The best of [`SCREENED`] draws from the prior and of its centre; the number of vectors tried.
fn screen(posterior: &Posterior<'_>, streams: Streams) -> (Vec<Vec<f64>>, u64) {
    let dimension = posterior.dimension();
    let draw = |k: usize| -> Vec<f64> {
        (0..dimension)
            .map(|i| match k {
                0 => 0.0,
                _ => streams.normal(0, k as u32, i as u32),
            })
            .collect()
    };
    let vectors: Vec<Vec<f64>> = (0..SCREENED).map(draw).collect();
    let densities = posterior.log_densities(&vectors);
    let mut order: Vec<usize> = (0..SCREENED).collect();
    order.sort_by(|a, b| densities[*b].total_cmp(&densities[*a]));
    let best = order[..SEARCHES].iter().map(|k| vectors[*k].clone());
    (best.collect(), SCREENED as u64)
}

/// Whitened values of all parameters, the noise that goes with them, and the number of vectors
/// tried.
fn settle(
    options: &FitOptions,
    posterior: &Posterior<'_>,
    optimum: &[f64],
    stds: &[f64],
) -> Result<(Vec<f64>, Noise, u64), FitError> {
    let free = stds.len();
    let kept: Vec<usize> = (0..free).filter(|k| stds[*k] < LEARNT).collect();
    if kept.len() == free {
        return Ok((optimum[..free].to_vec(), posterior.noise(optimum), 0));
    }
    let parameters: Vec<Parameter> = kept.iter().map(|k| options.parameters[*k]).collect();
    let smaller = posterior.with_parameters(&parameters)?;
    let start = kept.iter().map(|k| optimum[*k]);
    let start: Vec<f64> = start.chain(optimum[free..].iter().copied()).collect();
    let (best, tried) = optima(&smaller, &[start]);
    let mut values = vec![0.0; free];
    for (k, z) in kept.iter().zip(&best[0]) {
        values[*k] = *z;
    }
    Ok((values, smaller.noise(&best[0]), tried))
}

/// A parameter whose whitened coordinate came out at `z`, with a standard deviation; the constant
/// is left open.
fn fitted(parameter: Parameter, prior: Prior, [z, std]: [f64; 2]) -> FittedParameter {
    let learnt = std < LEARNT;
    let value = prior.value(z);
    FittedParameter {
        name: parameter.name(),
        parameter,
        unit: parameter.unit(),
        value,
        std: prior.spread(value, if learnt { std } else { 1.0 }),
        prior,
        prior_value: prior.value(0.0),
        prior_std: prior.spread(prior.value(0.0), 1.0),
        std_ratio: std,
        determined: std < DETERMINED,
        learnt,
        constant: None,
    }
}

fn correlation(covariance: &[Vec<f64>], free: usize) -> Vec<Vec<f64>> {
    let of = |i: usize, j: usize| {
        let scale = (covariance[i][i] * covariance[j][j]).sqrt();
        if i == j {
            1.0
        } else {
            covariance[i][j] / scale
        }
    };
    (0..free)
        .map(|i| (0..free).map(|j| of(i, j)).collect())
        .collect()
}

fn sampling(chain: &Chain, vectors: u64) -> Sampling {
    let split_rhat = chain.split_rhat();
    Sampling {
        vectors,
        acceptance: chain.acceptance(),
        split_rhat,
        effective_samples: chain.effective_samples(),
        settled: split_rhat <= SETTLED,
        unsolved: 0,
    }
}

impl Fit {
    /// Writes the fitted values into a setup.
    ///
    /// # Errors
    /// The fitted outline is none in this scene.
    pub fn apply(&self, setup: &mut Setup) -> Result<(), ShapeError> {
        let values = self.parameters.iter();
        let values: Vec<_> = values
            .map(|fitted| (fitted.parameter, fitted.value))
            .collect();
        Parameter::apply(&values, setup)
    }

    /// Samples of the posterior by name: 512 of each free parameter in its unit, also where the
    /// pushes do not determine it, then of `camera_scale` and `drift` as [`Noise`] has them. The
    /// k-th numbers belong together.
    #[must_use]
    pub fn draws(&self) -> Vec<(&'static str, Vec<f64>)> {
        let of_parameters = self.parameters.iter().enumerate().map(|(k, fitted)| {
            let values = self.samples.iter();
            let values = values.map(|sample| fitted.prior.value(sample[k]));
            (fitted.name, values.collect())
        });
        let noise = |of: fn(&Noise) -> f64| -> Vec<f64> {
            let samples = self.samples.iter();
            let noises = samples.map(|sample| noise_of(&sample[self.parameters.len()..]));
            noises.map(|noise| of(&noise)).collect()
        };
        let of_noise = [
            ("camera_scale", noise(|noise| noise.camera_scale)),
            ("drift", noise(|noise| noise.drift)),
        ];
        of_parameters.chain(of_noise).collect()
    }

    /// Adds the number of steps without a certified solution at the whitened `values`.
    fn with_unsolved(mut self, posterior: &Posterior<'_>, values: &[f64]) -> Self {
        let vector = [values.to_vec()];
        let unsolved = (0..posterior.pushes.len())
            .flat_map(|push| posterior.predictions(push, &vector))
            .map(|prediction| prediction.map_or(0, |prediction| prediction.unsolved));
        self.sampling.unsolved = unsolved.sum();
        self
    }
}
