//! Scores of an estimate against the truth or the log: [`score`].

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip_evaluation::{PIT_BINS, Reference, Scores, score as score_against};
use stickslip_formats::{Experiment, TruthFacts, estimate_of_columns};

use crate::columns::Columns;
use crate::error::refused;
use crate::given::Given;
use crate::log::{log_of, truth_of};
use crate::run_options::RunArguments;
use crate::scene::Scene;

/// Data that an estimate is scored on.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arguments<'py> {
    log: Bound<'py, PyDict>,
    scene: Bound<'py, Scene>,
    truth: Option<Bound<'py, PyDict>>,
    first_pusher_contact: Option<usize>,
    options: Given<RunArguments>,
    virtual_radius: Option<f64>,
}

/// The scores of an estimate's columns; NaN where there is nothing to score on.
#[pyfunction]
pub fn score<'py>(
    py: Python<'py>,
    estimate: &Bound<'py, PyDict>,
    on: Given<Arguments<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let on = on.0;
    let setup = &on.scene.get().setup;
    let held = Columns::of(estimate)?;
    let estimate = estimate_of_columns(&held.named()?).map_err(refused)?;
    let truth = on.truth.as_ref().map(truth_of).transpose()?;
    let facts = TruthFacts {
        first_pusher_contact: on.first_pusher_contact,
        ..TruthFacts::default()
    };
    let experiment =
        Experiment::new(setup.clone(), log_of(&on.log)?, truth, facts).map_err(refused)?;
    let hidden = on.options.0.occlusion()?.hidden(&experiment.log);
    let radius = on.virtual_radius.unwrap_or_else(|| setup.virtual_radius());
    let scores = score_against(&estimate, &Reference::of(&experiment), &hidden, radius);
    to_scores(py, &scores)
}

fn to_scores<'py>(py: Python<'py>, scores: &Scores) -> PyResult<Bound<'py, PyDict>> {
    // of the rows that the errors are of
    let belief = match scores.wmse_occluded_mm {
        Some(_) => scores.belief_occluded,
        None => scores.belief,
    };
    let named = [
        ("wmse_mm", scores.wmse_mm),
        ("wmse_occluded_mm", scores.wmse_occluded_mm),
        ("wmse_moving_mm", scores.wmse_moving_mm),
        ("spread_occluded_mm", scores.spread_occluded_mm),
        ("final_error_mm", scores.final_error_mm),
        ("final_error_deg", scores.final_error_deg),
        ("covered_90", belief.covered),
        ("crps_mm", belief.crps_mm),
    ];
    let dict = PyDict::new(py);
    for (name, value) in named {
        dict.set_item(name, value.unwrap_or(f64::NAN))?;
    }
    dict.set_item("pit", belief.pit.unwrap_or([f64::NAN; PIT_BINS]).to_vec())?;
    Ok(dict)
}
