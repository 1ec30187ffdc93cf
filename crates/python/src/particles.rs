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

/// Columns that are kept of a particle: the weight, the pose and the friction, then weight and
/// friction of one of those that have the estimate's.
const NAMES: [&str; 13] = [
    "weight",
    "x",
    "y",
    "theta",
    "mu_s",
    "mu_p",
    "mu_f",
    "d_tri",
    "friction_weight",
    "friction_mu_s",
    "friction_mu_p",
    "friction_mu_f",
    "friction_d_tri",
];

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
    /// The particles that have the estimate's friction, when the camera last saw the object: weight
    /// and friction.
    known: Option<Vec<[f64; 5]>>,
}

/// Weight and friction of each particle.
fn weighed_friction(particles: &ParticleView<'_>) -> Vec<[f64; 5]> {
    let weighed = particles.weights().iter().enumerate();
    weighed
        .map(|(particle, weight)| {
            let [mu_s, mu_p, mu_f, d_tri] = particles.friction(particle).fields().map(|x| *x);
            [*weight, mu_s, mu_p, mu_f, d_tri]
        })
        .collect()
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
        let Kept {
            rows,
            columns,
            known,
        } = &mut *kept;
        rows.push(row);
        let own = weighed_friction(particles);
        let known = known.as_ref().unwrap_or(&own);
        for (particle, (own, known)) in own.iter().zip(known).enumerate() {
            let [weight, friction @ ..] = own;
            let pose = particles.pose(particle);
            let numbers = [weight]
                .into_iter()
                .chain(pose.fields())
                .chain(friction)
                .chain(known);
            for (column, number) in columns.iter_mut().zip(numbers) {
                column.push(*number);
            }
        }
    }

    fn on_friction(&self, _: usize, particles: &ParticleView<'_>) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.known = Some(weighed_friction(particles));
    }
}

/// Rows that have particles (R,), and weight, pose and friction of each, and of those that have the
/// estimate's friction, (R * N,) row by row.
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
    let Kept { rows, columns, .. } = keeper
        .kept
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    let rows = PyArray1::from_iter(py, rows.into_iter().map(|row| row as i64));
    let columns = NAMES.map(str::to_owned).into_iter().zip(columns).collect();
    Ok((rows, to_dict(py, columns)?))
}
