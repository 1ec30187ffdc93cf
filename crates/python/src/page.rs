//! Pages about runs, as HTML text: [`report`], [`player`], [`comparison_page`].

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::Run;
use stickslip::diagnosis::{Finding, doubts};
use stickslip_cli::{
    CloudSample, ComparedFolder, ComparedRun, DRAWN, ShownScores, compared_method,
};
use stickslip_evaluation::{PIT_BINS, ScoredRun, Variant};
use stickslip_formats::{Experiment, TruthFacts, estimate_of_columns, read_truth_json};

use crate::columns::Columns;
use crate::error::{refused, warn};
use crate::filter::run_log;
use crate::given::Given;
use crate::log::{log_of, truth_of};
use crate::run_options::RunArguments;
use crate::scene::Scene;

/// An experiment as Python gives it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arguments<'py> {
    name: String,
    log: Bound<'py, PyDict>,
    scene: Bound<'py, Scene>,
    truth: Option<Bound<'py, PyDict>>,
    /// Text of truth.json.
    facts: Option<String>,
    options: Given<RunArguments>,
}

impl Arguments<'_> {
    fn experiment(&self) -> PyResult<Experiment> {
        let facts = match &self.facts {
            Some(text) => read_truth_json(text, "truth.json").map_err(refused)?,
            None => TruthFacts::default(),
        };
        let truth = self.truth.as_ref().map(truth_of).transpose()?;
        let setup = self.scene.get().setup.clone();
        Experiment::new(setup, log_of(&self.log)?, truth, facts).map_err(refused)
    }
}

/// Runs a method on an experiment; gives the page about it.
#[pyfunction]
#[pyo3(signature = (on, progress = None))]
pub fn report(
    py: Python<'_>,
    on: Given<Arguments<'_>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let on = on.0;
    let (experiment, options) = (on.experiment()?, &on.options.0);
    let scene = on.scene.get();
    let sample = CloudSample::new(DRAWN);
    let run = run_log(py, scene, &experiment.log, options, progress, Some(&sample))?;
    let doubts = doubts(&scene.setup, &experiment.log, &run);
    let warnings: Vec<String> = doubts.iter().map(Finding::to_string).collect();
    warn(py, &warnings)?;
    let run = sample.into_run(scored(run, &experiment, options)?);
    let origin = [
        (
            "program",
            format!("stickslip.report {}", env!("CARGO_PKG_VERSION")),
        ),
        ("scene", scene.name.clone()),
        ("particles", options.particles.to_string()),
        ("seed", options.seed.to_string()),
    ];
    let origin = origin.map(|(key, value)| (key.to_owned(), value));
    let run = (run, options.occlusion()?);
    Ok(stickslip_cli::run_page(
        &on.name,
        &experiment,
        run,
        &warnings,
        origin.into(),
    ))
}

/// A page that plays an estimate back.
#[pyfunction]
pub fn player(estimate: &Bound<'_, PyDict>, on: Given<Arguments<'_>>) -> PyResult<String> {
    let on = on.0;
    let (experiment, options) = (on.experiment()?, &on.options.0);
    let held = Columns::of(estimate)?;
    let run = Run {
        estimate: estimate_of_columns(&held.named()?).map_err(refused)?,
        unsolved: 0,
        failed: 0,
        collapses: 0,
        log_evidence: None,
    };
    let scored = scored(run, &experiment, options)?;
    let occlusion = options.occlusion()?;
    Ok(stickslip_cli::run_player(&experiment, scored, occlusion))
}

fn scored(run: Run, experiment: &Experiment, options: &RunArguments) -> PyResult<ScoredRun> {
    let asked = options.options()?;
    let variant = Variant::of(asked.method, asked.tactile);
    let how = (asked.occlusion, experiment.setup.virtual_radius());
    Ok(ScoredRun::of(variant, run, experiment, how))
}

/// A row of a comparison.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Compared {
    folder: String,
    variant: String,
    wmse_mm: f64,
    wmse_occluded_mm: f64,
    wmse_moving_mm: f64,
    final_error_mm: f64,
    final_error_deg: f64,
    covered_90: f64,
    crps_mm: f64,
    pit: [f64; PIT_BINS],
    unsolved: u64,
    collapses: u32,
    warnings: Vec<String>,
}

/// The page about the rows of a comparison, with players of the logs among `on`.
#[pyfunction]
pub fn comparison_page(
    py: Python<'_>,
    rows: Vec<Given<Compared>>,
    on: Vec<Given<Arguments<'_>>>,
    options: Given<RunArguments>,
) -> PyResult<String> {
    let runs = rows.into_iter().map(|row| compared(row.0));
    let runs = runs.collect::<PyResult<Vec<_>>>()?;
    let asked = options.0.options()?;
    let folder = |on: &Arguments<'_>| {
        Ok(ComparedFolder {
            path: PathBuf::from(&on.name),
            experiment: on.experiment()?,
            occlusion: on.options.0.occlusion()?,
            tracking: asked.tracking,
        })
    };
    let folders = on.iter().map(|on| folder(&on.0));
    let folders = folders.collect::<PyResult<Vec<_>>>()?;
    let (particles, model) = (asked.particles, asked.model);
    let page = py.detach(|| stickslip_cli::comparison_page(&runs, particles, model, &folders));
    page.map_err(refused)
}

fn compared(row: Compared) -> PyResult<ComparedRun> {
    let known = |score: f64| Some(score).filter(|score| score.is_finite());
    let variant = compared_method(&row.variant);
    Ok(ComparedRun {
        folder: row.folder,
        variant: variant
            .ok_or_else(|| refused(format!("there is no variant `{}`", row.variant)))?,
        scores: ShownScores {
            wmse_mm: known(row.wmse_occluded_mm).or(known(row.wmse_mm)),
            wmse_moving_mm: known(row.wmse_moving_mm),
            final_error_mm: known(row.final_error_mm),
            final_error_deg: known(row.final_error_deg),
            covered_90: known(row.covered_90),
            crps_mm: known(row.crps_mm),
            pit: known(row.crps_mm).map(|_| row.pit),
            unsolved: row.unsolved,
            collapses: row.collapses,
            ..ShownScores::default()
        },
        warnings: row.warnings,
    })
}
