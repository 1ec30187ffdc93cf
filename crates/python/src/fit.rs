//! Fit of friction parameters to many pushes: [`fit`].

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip_fit::{
    CrossValidation, Fit, FitError, FitOptions, Parameter, Push, cross_validate, default_folds,
    doubts,
};

use crate::columns::to_dict;
use crate::error::{refused, warn};
use crate::given::Given;
use crate::log::log_of;
use crate::long_call::long_call;
use crate::scene::Scene;
use crate::threads::{Threads, processors};

/// The items of a dict of options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arguments {
    free: Vec<String>,
    seed: u64,
    folds: Option<usize>,
    threads: Option<usize>,
}

/// Name, scene and columns of the log.
type PushArguments<'py> = (String, Bound<'py, Scene>, Bound<'py, PyDict>);

/// The fit and its cross-validation as in fit.json, draws by name, the first scene's text with the
/// values in place, reasons to doubt the fit, and the page about it.
type Fitted<'py> = (
    String,
    String,
    Bound<'py, PyDict>,
    String,
    Vec<String>,
    String,
);

/// Learns from pushes of one object on one table.
#[pyfunction]
#[pyo3(signature = (pushes, options, progress = None))]
pub fn fit<'py>(
    py: Python<'py>,
    pushes: Vec<PushArguments<'py>>,
    options: Given<Arguments>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Fitted<'py>> {
    let options = options.0;
    let scene = pushes.first().map(|(_, scene, _)| scene.clone());
    let pushes: Vec<Push> = pushes.into_iter().map(push_of).collect::<PyResult<_>>()?;
    let parameters = match pushes.first() {
        Some(first) => Parameter::list_or_default(&options.free, &first.setup),
        None => Ok(Vec::new()), // too few pushes
    };
    let fit_options = FitOptions {
        parameters: parameters.map_err(refused)?,
        seed: options.seed,
    };
    let folds = options.folds.unwrap_or(default_folds(pushes.len()));
    let threads = Threads {
        asked: options.threads,
        useful: processors(),
    };
    let learnt = long_call(py, threads, progress, |watch| {
        // the fits of the folds take as long as the first one
        let fits = folds as u64 + 1;
        let of_fit = |done: u64, most: u64| watch.show(done, fits * most);
        let fit = stickslip_fit::fit(&pushes, &fit_options, &of_fit)?;
        let of_folds = |done: u64, most: u64| {
            let one = most / folds as u64;
            watch.show(one + done, one + most);
        };
        let validate = || cross_validate(&pushes, folds, &fit_options, &of_folds);
        Ok((fit, (folds > 0).then(validate).transpose()?))
    })?;
    let learnt: Result<(Fit, Option<CrossValidation>), FitError> = learnt;
    let (fit, validation) = learnt.map_err(refused)?;

    let columns = fit.draws().into_iter();
    let columns = columns.map(|(name, draws)| (name.to_owned(), draws));
    let scene = scene.expect("a fit has pushes");
    let text = fit.scene_text(&scene.get().text, &scene.get().name, validation.as_ref());
    let warnings = doubts(&pushes, &fit);
    warn(py, &warnings)?;
    let page = stickslip_cli::fit_page(&pushes, &fit, validation.as_ref(), &warnings, options.seed);
    Ok((
        json(&fit)?,
        json(&validation)?,
        to_dict(py, columns.collect())?,
        text.map_err(refused)?,
        warnings,
        page,
    ))
}

fn push_of((name, scene, columns): PushArguments<'_>) -> PyResult<Push> {
    Ok(Push {
        name,
        setup: scene.get().setup.clone(),
        log: log_of(&columns)?,
    })
}

fn json(result: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(result).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}
