//! One method over one log: [`filter`].

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::{Log, Observer, Run, keep_threads_awake, run, run_observed, useful_threads};
use stickslip_formats::{check_sensors, estimate_columns};

use crate::columns::to_dict;
use crate::error::refused;
use crate::given::Given;
use crate::log::log_of;
use crate::run_options::RunArguments;
use crate::scene::Scene;
use crate::threads::on_threads;

/// The columns of estimate.csv for a log's columns.
#[pyfunction]
pub fn filter<'py>(
    py: Python<'py>,
    log: &Bound<'py, PyDict>,
    scene: &Bound<'py, Scene>,
    options: Given<RunArguments>,
) -> PyResult<Bound<'py, PyDict>> {
    let log = log_of(log)?;
    let run = run_log(py, scene.get(), &log, &options.0, None)?;
    to_dict(py, estimate_columns(&run.estimate))
}

/// Runs a method without the interpreter's lock.
pub fn run_log(
    py: Python<'_>,
    scene: &Scene,
    log: &Log,
    arguments: &RunArguments,
    observer: Option<&dyn Observer>,
) -> PyResult<Run> {
    check_sensors(log, &scene.setup).map_err(refused)?;
    let options = arguments.options()?;
    let useful = useful_threads(options.particles);
    let track = || {
        keep_threads_awake(|| match observer {
            Some(observer) => run_observed(&scene.setup, log, &options, observer, &mut |_| ()),
            None => run(&scene.setup, log, &options, &mut |_| ()),
        })
    };
    let run = py.detach(|| on_threads(arguments.threads, useful, track))?;
    run.map_err(refused)
}
