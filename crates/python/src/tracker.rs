//! One row at a time: [`Tracker`].

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::{Estimate, PoseCovariance, Row, TrackerOptions};
use stickslip_dynamics::Pose;
use stickslip_formats::estimate_columns;

use crate::error::refused;
use crate::given::{Given, Reading};
use crate::run_options::{model, touch};
use crate::scene::Scene;

/// Variances of x, y, θ, then the covariances of x with y, x with θ, y with θ.
fn covariance([x, y, theta, x_y, x_theta, y_theta]: [f64; 6]) -> PoseCovariance {
    PoseCovariance {
        x,
        y,
        theta,
        x_y,
        x_theta,
        y_theta,
    }
}

/// A particle filter that takes one row at a time, on the caller's thread.
#[pyclass(module = "stickslip._native")]
pub struct Tracker {
    tracker: stickslip::Tracker<'static>,
    fixels: usize,
    has_tripod: bool,
}

/// The items of a dict of options.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Arguments {
    model: String,
    particles: usize,
    seed: u64,
    tactile: bool,
    substeps: Option<u32>,
    late: f64,
}

type Numbers = [f64; 3];

/// The items of a dict that is a row.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Measured {
    time: f64,
    object: Option<Numbers>,
    object_covariance: Option<[f64; 6]>,
    pusher: Option<Numbers>,
    tactile: Vec<Option<Reading>>,
    force: Option<[f64; 2]>,
}

#[pymethods]
impl Tracker {
    #[new]
    fn new(scene: &Bound<'_, Scene>, options: Given<Arguments>) -> PyResult<Self> {
        let setup = &scene.get().setup;
        let options = options.0;
        let options = TrackerOptions {
            model: model(&options.model)?,
            particles: options.particles,
            seed: options.seed,
            tactile: touch(options.tactile),
            substeps: options.substeps,
            late: options.late,
            ..TrackerOptions::default()
        };
        Ok(Self {
            tracker: stickslip::Tracker::new(setup, &options).map_err(refused)?,
            fixels: setup.scene.fixels.len(),
            has_tripod: setup.has_tripod(),
        })
    }

    /// Takes a row, gives the estimate at the latest one.
    fn push<'py>(&mut self, py: Python<'py>, row: Given<Measured>) -> PyResult<Bound<'py, PyDict>> {
        let row = row.0;
        let pose = |[x, y, theta]: Numbers| Pose::new(x, y, theta);
        let row = Row {
            time: row.time,
            object: row.object.map(pose),
            object_covariance: row.object_covariance.map(covariance),
            pusher: row.pusher.map(pose),
            tactile: row
                .tactile
                .iter()
                .map(|reading| reading.map(|r| r.0))
                .collect(),
            force: row.force,
        };
        let tracker = &mut self.tracker;
        py.detach(|| tracker.push(&row).map(|_| ()))
            .map_err(refused)?;
        self.estimate(py)
    }

    /// The estimate at the latest row.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let one = Estimate {
            time: vec![self.tracker.time().unwrap_or(f64::NAN)],
            rows: vec![self.tracker.estimate().clone()],
            fixels: self.fixels,
            has_tripod: self.has_tripod,
        };
        let numbers = PyDict::new(py);
        for (name, column) in estimate_columns(&one) {
            numbers.set_item(name, column[0])?;
        }
        Ok(numbers)
    }

    /// Rows at which no particle explained the camera.
    #[getter]
    fn collapses(&self) -> u32 {
        self.tracker.collapses()
    }
}
