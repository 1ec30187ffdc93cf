//! Options of a run over a log, as Python gives them: [`RunArguments`].

use pyo3::prelude::*;
use stickslip::{FilterModel, Method, Occlusion, RunOptions, TactileUse, Tracking};

use crate::error::refused;

/// The items of a dict of options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RunArguments {
    method: String,
    model: String,
    pub particles: usize,
    pub seed: u64,
    tactile: bool,
    causal: bool,
    substeps: Option<u32>,
    occlude: Option<(usize, Option<usize>)>,
    occlude_middle: Option<f64>,
    /// True to run also if units, frames or columns are found to be wrong.
    pub force: bool,
    pub threads: Option<usize>,
}

impl RunArguments {
    /// The library's options.
    pub fn options(&self) -> PyResult<RunOptions> {
        if self.particles == 0 {
            return Err(refused("0 particles are asked for; it must be 1 or more"));
        }
        Ok(RunOptions {
            method: method(&self.method)?,
            model: model(&self.model)?,
            particles: self.particles,
            seed: self.seed,
            tactile: touch(self.tactile),
            tracking: if self.causal {
                Tracking::Causal
            } else {
                Tracking::Smoothed
            },
            substeps: self.substeps,
            occlusion: self.occlusion()?,
            ..RunOptions::default()
        })
    }

    /// Rows that are hidden.
    pub fn occlusion(&self) -> PyResult<Occlusion> {
        match (self.occlude, self.occlude_middle) {
            (None, None) => Ok(Occlusion::None),
            (Some((from, to)), None) => Ok(Occlusion::Rows { from, to }),
            (None, Some(seconds)) => Ok(Occlusion::Middle { seconds }),
            (Some(_), Some(_)) => Err(refused(
                "occlude and occlude_middle are both given; a log is hidden in one way. Leave one out",
            )),
        }
    }
}

/// The method of a name.
pub fn method(name: &str) -> PyResult<Method> {
    match name {
        "particle" => Ok(Method::Particle),
        "kalman" => Ok(Method::Kalman),
        "kalman-stops" => Ok(Method::KalmanStops),
        "with-pusher" => Ok(Method::WithPusher),
        "extended-kalman" => Ok(Method::ExtendedKalman),
        "nominal" => Ok(Method::Nominal),
        _ => Err(refused(format!(
            "method is `{name}`; it must be `particle`, `kalman`, `kalman-stops`, `with-pusher`, `extended-kalman` or `nominal`"
        ))),
    }
}

/// The filter model of a name.
pub fn model(name: &str) -> PyResult<FilterModel> {
    match name {
        "robust" => Ok(FilterModel::Robust),
        "paper" => Ok(FilterModel::Paper),
        _ => Err(refused(format!(
            "model is `{name}`; it must be `robust` or `paper`"
        ))),
    }
}

/// Use of touch: used or ignored.
pub fn touch(used: bool) -> TactileUse {
    if used {
        TactileUse::Used
    } else {
        TactileUse::Ignored
    }
}
