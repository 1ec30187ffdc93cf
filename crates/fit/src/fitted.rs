//! Fit of parameters to pushes: [`fit`].

use serde::{Deserialize, Serialize};
use stickslip::{Setup, quantile};
use stickslip_dynamics::ShapeError;
use stickslip_filter::Streams;

use crate::chain::Chain;
use crate::error::FitError;
use crate::likelihood::Noise;
use crate::parameter::Parameter;
use crate::posterior::{Posterior, noise_of};
use crate::prior::Prior;
use crate::progress::{Listener, Progress};
use crate::push::{PreparedPush, Push, by_object};
use crate::sampler::{most_sampled, sample};

/// Posterior over prior standard deviation below which a parameter counts as determined.
const DETERMINED: f64 = 0.5;

/// Posterior over prior standard deviation up to which a scene takes the fitted value. Above, the
/// pushes say next to nothing, and it keeps its first guess.
const LEARNT: f64 = 0.8;

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

/// Names of the two numbers of the noise, in the order of a vector.
const NOISE_NAMES: [&str; 2] = ["camera_scale", "drift"];

/// Parts of the populations' ways in which their means are compared.
const PARTS: usize = 10;

/// Result of a fit to some pushes.
#[derive(Clone, Debug, Serialize, Deserialize)]
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
    /// Agreement of the populations on each parameter, then on the two numbers of `noise`.
    pub chains: Vec<Agreement>,
    /// Pushes that teach nothing, since nothing touches the object, each with what was found.
    pub left_out: Vec<String>,
    /// Samples of the posterior, as [`Posterior`] takes them; none in a fit that was read.
    #[serde(skip)]
    pub(crate) samples: Vec<Vec<f64>>,
}

/// A parameter before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FittedParameter {
    /// The parameter.
    #[serde(rename = "name")]
    pub parameter: Parameter,
    /// Symbol of its unit; empty for a bare number.
    pub unit: String,
    /// The posterior's mean, of the logarithm where the prior is of that.
    pub value: f64,
    /// Its standard deviation.
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
    /// Ends of the 90 % interval.
    pub interval_90: [f64; 2],
}

/// Facts about the exploration of the posterior.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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

/// Agreement of the populations on one number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Name of the parameter, `camera_scale` or `drift`.
    pub name: String,
    /// Split R̂.
    pub split_rhat: f64,
    /// Independent samples that the chains are worth.
    pub effective_samples: f64,
    /// Mean of each population in each tenth of its way, in standard deviations of the prior from
    /// its centre.
    pub population_means: Vec<Vec<f64>>,
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
    let (prepared, left_out) = prepare(pushes, &progress)?;
    let fit = fit_prepared(&prepared.iter().collect::<Vec<_>>(), options, &progress)?;
    Ok(Fit { left_out, ..fit })
}

/// Pushes made ready, at least two; and those in which nothing touches the object, in words.
pub(crate) fn prepare(
    pushes: &[Push],
    progress: &Progress<'_>,
) -> Result<(Vec<PreparedPush>, Vec<String>), FitError> {
    if let [first, second, ..] = &by_object(pushes)[..] {
        let [first, second] = [first, second].map(|object| pushes[object[0]].name.clone());
        return Err(FitError::SeveralObjects { first, second });
    }
    let (mut ready, mut left_out) = (Vec::new(), Vec::new());
    for push in pushes {
        progress.show();
        match PreparedPush::new(push.clone()) {
            Ok(push) => ready.push(push),
            Err(error @ FitError::Untouched { .. }) => left_out.push(error),
            Err(error) => return Err(error),
        }
    }
    let (pushes, least) = (ready.len(), 2);
    if pushes < least {
        let too_few = FitError::TooFewPushes { pushes, least };
        return Err(left_out.into_iter().next().unwrap_or(too_few));
    }
    let left_out = left_out.iter().map(FitError::to_string);
    Ok((ready, left_out.collect()))
}

impl FitOptions {
    /// Upper limit of the number of vectors that a fit tries.
    pub(crate) fn most_vectors(&self) -> u64 {
        most_sampled(!self.parameters.iter().all(|free| free.keeps_scene()))
    }
}

pub(crate) fn fit_prepared<'a>(
    pushes: &[&'a PreparedPush],
    options: &FitOptions,
    progress: &'a Progress<'a>,
) -> Result<Fit, FitError> {
    let posterior = Posterior::new(pushes.to_vec(), &options.parameters, progress)?;
    let streams = Streams::new(options.seed);

    let (chain, sampled) = sample(&posterior, &|mean| posterior.power(mean), SETTLED, streams);
    let covariance = chain.covariance();
    let free = options.parameters.len();
    let means = chain.means();
    let samples = chain.thinned(KEPT_SAMPLES);
    let parameters = posterior.parameters.iter().enumerate();
    let fit = Fit {
        pushes: pushes.len(),
        parameters: parameters
            .map(|(k, &(parameter, prior))| {
                let values: Vec<f64> = samples.iter().map(|sample| sample[k]).collect();
                let moments = [means[k], covariance[k][k].sqrt()];
                fitted(parameter, prior, moments, &values)
            })
            .collect(),
        correlation: correlation(&covariance, free),
        noise: posterior.noise(&means),
        left_out: Vec::new(),
        sampling: sampling(&chain, sampled),
        chains: chains(&chain, options),
        samples,
    };
    Ok(fit.with_unsolved(&posterior, &means))
}

/// A parameter, by mean, standard deviation and samples of its whitened coordinate.
fn fitted(
    parameter: Parameter,
    prior: Prior,
    [mean, std]: [f64; 2],
    samples: &[f64],
) -> FittedParameter {
    let value = prior.value(mean);
    let end = |q| prior.value(quantile(samples, q).expect("there are samples"));
    FittedParameter {
        parameter,
        unit: parameter.unit().to_owned(),
        value,
        std: prior.spread(value, std),
        interval_90: [0.05, 0.95].map(end),
        prior,
        prior_value: prior.value(0.0),
        prior_std: prior.spread(prior.value(0.0), 1.0),
        std_ratio: std,
        determined: std < DETERMINED,
        learnt: std < LEARNT,
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

/// Agreement of the populations on the parameters of `options` and on the noise.
fn chains(chain: &Chain, options: &FitOptions) -> Vec<Agreement> {
    let parameters = options.parameters.iter().map(|parameter| parameter.name());
    let names = parameters.chain(NOISE_NAMES);
    let of = |(k, name): (usize, &str)| Agreement {
        name: name.to_owned(),
        split_rhat: chain.split_rhat_of(k),
        effective_samples: chain.effective_samples_of(k),
        population_means: chain.ensemble_means_of(k, PARTS),
    };
    names.enumerate().map(of).collect()
}

impl FittedParameter {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.parameter.name()
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
            (fitted.name(), values.collect())
        });
        let noise = |of: fn(&Noise) -> f64| -> Vec<f64> {
            let samples = self.samples.iter();
            let noises = samples.map(|sample| noise_of(&sample[self.parameters.len()..]));
            noises.map(|noise| of(&noise)).collect()
        };
        let of_noise = [
            noise(|noise| noise.camera_scale),
            noise(|noise| noise.drift),
        ];
        let of_noise = NOISE_NAMES.into_iter().zip(of_noise);
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
