//! The particles of a run after some of its rows: [`particles`].

use std::sync::{Mutex, PoisonError};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::{Observer, ParticleView, SolvedStep};

use crate::columns::to_dict;
use crate::filter::run_log;
use crate::given::Given;
use crate::log::log_of;
use crate::run_options::RunArguments;
use crate::scene::Scene;

/// Columns that are kept of a particle: the weight, the pose and the friction.
pub const NAMES: [&str; 8] = ["weight", "x", "y", "theta", "mu_s", "mu_p", "mu_f", "d_tri"];

/// Keeps the particles after some rows.
#[derive(Debug)]
struct Keeper {
    /// Rows to keep, rising; `None`: all.
    rows: Option<Vec<usize>>,
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    rows: Vec<usize>,
    columns: [Vec<f64>; NAMES.len()],
}

impl Observer for Keeper {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        if self
            .rows
            .as_ref()
            .is_some_and(|rows| rows.binary_search(&row).is_err())
        {
            return;
        }
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let Kept { rows, columns } = &mut *kept;
        rows.push(row);
        push_particles(columns, particles);
    }
}

/// Appends the particles to the columns of [`NAMES`].
pub fn push_particles(columns: &mut [Vec<f64>; NAMES.len()], particles: &ParticleView<'_>) {
    for (particle, weight) in particles.weights().iter().enumerate() {
        let (pose, friction) = (particles.pose(particle), particles.friction(particle));
        let numbers = [weight]
            .into_iter()
            .chain(pose.fields())
            .chain(friction.fields());
        for (column, number) in columns.iter_mut().zip(numbers) {
            column.push(*number);
        }
    }
}

/// Rows that have particles (R,), and weight, pose and friction of each, (R * N,) row by row.
#[pyfunction]
#[pyo3(signature = (log, scene, options, rows = None, progress = None))]
pub fn particles<'py>(
    py: Python<'py>,
    log: &Bound<'py, PyDict>,
    scene: &Bound<'py, Scene>,
    options: Given<RunArguments>,
    rows: Option<Vec<usize>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyDict>)> {
    let log = log_of(log)?;
    let mut rows = rows;
    if let Some(rows) = &mut rows {
        rows.sort_unstable();
    }
    let keeper = Keeper {
        rows,
        kept: Mutex::default(),
    };
    run_log(py, scene.get(), &log, &options.0, progress, Some(&keeper))?;
    let Kept { rows, columns } = keeper
        .kept
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    let rows = PyArray1::from_iter(py, rows.into_iter().map(|row| row as i64));
    let columns = NAMES.map(str::to_owned).into_iter().zip(columns).collect();
    Ok((rows, to_dict(py, columns)?))
}
