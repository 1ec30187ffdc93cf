//! Experiments with known truth: [`simulate`].

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip_evaluation::{PUSHER_MEMORY, Physics, REPEATS, Seeds, Simulation, SimulationOptions};
use stickslip_formats::{TruthFacts, log_columns, truth_columns, write_truth_json};

use crate::columns::to_dict;
use crate::error::refused;
use crate::given::Given;
use crate::long_call::long_call;
use crate::scene::Scene;
use crate::threads::Threads;

/// The items of a dict of options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Arguments {
    physics: String,
    rig_seed: u64,
    noise_seed: u64,
    rate: f64,
    mu_s: Option<f64>,
    mu_p: Option<f64>,
    mu_f: Option<f64>,
    d_tri: Option<f64>,
}

/// Columns of the log, columns of the truth, truth.json, and steps without a certified solution.
type Simulated<'py> = (Bound<'py, PyDict>, Bound<'py, PyDict>, String, usize);

/// Simulates the experiment of a scene.
#[pyfunction]
#[pyo3(signature = (scene, options, progress = None))]
pub fn simulate<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    options: Given<Arguments>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Simulated<'py>> {
    let options = options.0;
    let known = TruthFacts {
        mu_s: options.mu_s,
        mu_p: options.mu_p,
        mu_f: options.mu_f,
        d_tri: options.d_tri,
        ..TruthFacts::default()
    };
    let options = SimulationOptions {
        physics: physics(&options.physics)?,
        seeds: Seeds {
            rig: options.rig_seed,
            noise: options.noise_seed,
        },
        rate: options.rate,
        repeats: REPEATS,
        pusher_memory: PUSHER_MEMORY,
    };
    let setup = &scene.get().setup;
    let threads = Threads {
        asked: None,
        useful: 1,
    };
    let simulation = long_call(py, threads, progress, |watch| {
        let mut finished = |done: usize, all: usize| watch.show(done as u64, all as u64);
        Simulation::run(setup, &known, &options, &mut finished)
    })?;
    let simulation = simulation.map_err(refused)?;
    let mut facts = Vec::new();
    write_truth_json(&mut facts, &simulation.facts)?;
    Ok((
        to_dict(py, log_columns(&simulation.log))?,
        to_dict(py, truth_columns(&simulation.truth))?,
        String::from_utf8(facts)?,
        simulation.trace.unsolved,
    ))
}

fn physics(name: &str) -> PyResult<Physics> {
    match name {
        "testbed" => Ok(Physics::Testbed),
        "model" => Ok(Physics::Model),
        _ => Err(refused(format!(
            "physics is `{name}`; it must be `testbed` or `model`"
        ))),
    }
}
