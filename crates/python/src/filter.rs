//! One method over one log: [`filter`], [`run_log`]; findings about a scene and a log: [`check`].

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::diagnosis::{Finding, diagnose, doubts};
use stickslip::{
    Log, Observer, ParticleView, Run, SolvedStep, keep_threads_awake, run_observed, useful_threads,
};
use stickslip_dynamics::{Particles, StepInput};
use stickslip_evaluation::LearnedParameter;
use stickslip_formats::{check_bodies, estimate_columns};

use crate::columns::to_dict;
use crate::error::{refused, warn};
use crate::given::Given;
use crate::log::log_of;
use crate::long_call::{Watch, long_call};
use crate::run_options::RunArguments;
use crate::scene::Scene;
use crate::threads::Threads;

/// Particles side by side in a step.
const LANES: usize = 8;

/// Subject, severity, what was found, advice.
type FindingParts = (String, String, String, Option<String>);

/// The columns of estimate.csv for a log's columns, and facts of the run.
#[pyfunction]
#[pyo3(signature = (log, scene, options, progress = None))]
pub fn filter<'py>(
    py: Python<'py>,
    log: &Bound<'py, PyDict>,
    scene: &Bound<'py, Scene>,
    options: Given<RunArguments>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
    let (log, scene) = (log_of(log)?, scene.get());
    let run = run_log(py, scene, &log, &options.0, progress, None)?;
    let warnings: Vec<String> = doubts(&scene.setup, &log, &run)
        .iter()
        .map(Finding::to_string)
        .collect();
    warn(py, &warnings)?;
    let facts = PyDict::new(py);
    facts.set_item("warnings", warnings)?;
    facts.set_item(
        "observed",
        observed(py, &LearnedParameter::all(&run.estimate))?,
    )?;
    facts.set_item("log_evidence", run.log_evidence)?;
    facts.set_item("collapses", run.collapses)?;
    Ok((to_dict(py, estimate_columns(&run.estimate))?, facts))
}

/// True or False by the name of each friction parameter: identified or not.
pub fn observed<'py>(
    py: Python<'py>,
    parameters: &[LearnedParameter],
) -> PyResult<Bound<'py, PyDict>> {
    let observed = PyDict::new(py);
    for parameter in parameters {
        observed.set_item(parameter.name, parameter.observed)?;
    }
    Ok(observed)
}

/// The findings of `stickslip check`.
#[pyfunction]
pub fn check(
    py: Python<'_>,
    log: &Bound<'_, PyDict>,
    scene: &Bound<'_, Scene>,
) -> PyResult<Vec<FindingParts>> {
    let (log, setup) = (log_of(log)?, &scene.get().setup);
    check_bodies(&log, setup).map_err(refused)?;
    let parts = |finding: Finding| {
        let (subject, severity) = (finding.subject.to_string(), finding.severity.to_string());
        (subject, severity, finding.found, finding.advice)
    };
    let findings = py.detach(|| diagnose(setup, &log));
    Ok(findings.into_iter().map(parts).collect())
}

/// Runs a method on threads; the observer is shown rows and friction.
pub fn run_log(
    py: Python<'_>,
    scene: &Scene,
    log: &Log,
    arguments: &RunArguments,
    progress: Option<Py<PyAny>>,
    observer: Option<&dyn Observer>,
) -> PyResult<Run> {
    check_bodies(log, &scene.setup).map_err(refused)?;
    let options = arguments.options()?;
    stickslip_cli::check_occlusion(options.occlusion, log).map_err(refused)?;
    if !arguments.force {
        stickslip_cli::check_sense(&scene.setup, log).map_err(refused)?;
    }
    let threads = Threads {
        asked: arguments.threads,
        useful: useful_threads(options.particles),
    };
    let rows = log.len() as u64;
    let run = long_call(py, threads, progress, |watch| {
        let watched = Watched { watch, observer };
        let mut finished = |row: usize| watch.show(row as u64 + 1, rows);
        keep_threads_awake(|| run_observed(&scene.setup, log, &options, &watched, &mut finished))
    })?;
    run.map_err(refused)
}

/// An observer that ends the run where the call is interrupted, also within a row.
#[derive(Debug)]
struct Watched<'a> {
    watch: &'a Watch,
    observer: Option<&'a dyn Observer>,
}

impl Observer for Watched<'_> {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn wants_steps(&self) -> bool {
        false
    }

    fn before_step(&self, _: &StepInput, _: &[Particles<LANES>]) {
        self.watch.check();
    }

    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        if let Some(observer) = self.observer {
            observer.on_row(row, particles);
        }
    }
}
