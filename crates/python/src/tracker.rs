//! One row at a time: [`Tracker`].

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip::diagnosis::{Finding, Severity, Subject};
use stickslip::{Estimate, Plan, PlanError, PoseCovariance, Row, RowError, TrackerOptions};
use stickslip_dynamics::{Body, Pose};
use stickslip_evaluation::LearningFriction;
use stickslip_formats::estimate_columns;

use crate::columns::to_dict;
use crate::error::{refused, warn};
use crate::filter::observed;
use crate::given::{Given, Reading};
use crate::particles::{NAMES, push_particles};
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

/// A particle filter that takes one row at a time, on the caller's thread. Threads wait for their
/// turns.
#[pyclass(frozen, module = "stickslip._native")]
pub struct Tracker(Mutex<State>);

#[derive(Clone)]
struct State {
    tracker: stickslip::Tracker<'static>,
    learning: LearningFriction,
    /// Warnings that were issued, by subject and severity.
    warned: Vec<(Subject, Severity)>,
    others: usize,
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
    fingers: Vec<Option<Numbers>>,
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
        let tracker = stickslip::Tracker::new(setup, &options).map_err(refused)?;
        Ok(Self(Mutex::new(State {
            tracker,
            learning: LearningFriction::new(setup),
            warned: Vec::new(),
            others: setup.scene.others(),
            has_tripod: setup.has_tripod(),
        })))
    }

    /// Takes a row, gives the estimate at the latest one.
    fn push<'py>(&self, py: Python<'py>, row: Given<Measured>) -> PyResult<Bound<'py, PyDict>> {
        let row = row.0;
        let pose = |[x, y, theta]: Numbers| Pose::new(x, y, theta);
        let row = Row {
            time: row.time,
            object: row.object.map(pose),
            object_covariance: row.object_covariance.map(covariance),
            pusher: row.pusher.map(pose),
            other_fingers: row.fingers.iter().map(|own| own.map(pose)).collect(),
            tactile: row
                .tactile
                .iter()
                .map(|reading| reading.map(|r| r.0))
                .collect(),
            force: row.force,
        };
        let pushed = self.with(py, |state| {
            state.tracker.push(&row)?;
            state.learning.add(state.tracker.estimate());
            Ok((state.new_doubts(), state.estimate()))
        });
        let (doubts, estimate) = pushed.map_err(|error: RowError| refused(error))?;
        warn(py, &doubts)?;
        to_numbers(py, &estimate)
    }

    /// The estimate at the latest row.
    fn estimate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_numbers(py, &self.with(py, |state| state.estimate()))
    }

    /// Reasons to doubt the estimates so far.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        let doubts = self.with(py, |state| state.tracker.doubts());
        doubts.iter().map(Finding::to_string).collect()
    }

    /// Friction parameters, identified or not.
    #[getter]
    fn observed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        observed(py, &self.with(py, |state| state.learning.parameters()))
    }

    /// The particles after the latest row, by the names of columns; none before the first pose.
    fn particles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(py, self.with(py, |state| state.particles()))
    }

    /// Probabilities of how a plan ends: poses (T + 1) of each finger, `h` seconds apart.
    fn outcomes<'py>(
        &self,
        py: Python<'py>,
        fingers: Vec<Vec<Numbers>>,
        h: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let poses = |places: &Vec<Numbers>| {
            let places = places.iter();
            places
                .map(|[x, y, theta]| Pose::new(*x, *y, *theta))
                .collect()
        };
        let fingers = fingers.iter().map(poses).collect();
        let plan = Plan { h, fingers };
        let ends = self.with(py, |state| state.tracker.outcomes(&plan));
        let ends = ends.map_err(|error: PlanError| refused(error))?;
        let dict = PyDict::new(py);
        for (name, number) in [
            ("held", ends.held),
            ("jammed", ends.jammed),
            ("resting", ends.resting),
            ("moving", ends.moving),
            ("lost", ends.lost),
            ("x", ends.pose.x),
            ("y", ends.pose.y),
            ("theta", ends.pose.theta),
            ("std_x", ends.spread.x),
            ("std_y", ends.spread.y),
            ("std_theta", ends.spread.theta),
            ("unsolved", ends.unsolved),
        ] {
            dict.set_item(name, number)?;
        }
        let contacts = ends.contacts.iter().map(|set| {
            let bodies = set.bodies.iter().map(Body::to_string);
            (bodies.collect::<Vec<String>>(), set.probability)
        });
        dict.set_item("contacts", contacts.collect::<Vec<_>>())?;
        Ok(dict)
    }

    /// A tracker that goes on by itself.
    fn copy(&self, py: Python<'_>) -> Self {
        Self(Mutex::new(self.with(py, |state| state.clone())))
    }

    /// ln of the evidence of the rows so far.
    #[getter]
    fn log_evidence(&self, py: Python<'_>) -> f64 {
        self.with(py, |state| state.tracker.log_evidence())
    }

    /// Rows at which no particle explained the camera.
    #[getter]
    fn collapses(&self, py: Python<'_>) -> u32 {
        self.with(py, |state| state.tracker.collapses())
    }
}

impl Tracker {
    /// Result of `work` on the tracker, once no other thread has it; without the interpreter's
    /// lock.
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut State) -> T + Send) -> T {
        py.detach(|| work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

impl State {
    /// Doubts of a kind or severity that there was none of before.
    fn new_doubts(&mut self) -> Vec<String> {
        let mut new = Vec::new();
        for doubt in self.tracker.doubts() {
            let kind = (doubt.subject, doubt.severity);
            if !self.warned.contains(&kind) {
                self.warned.push(kind);
                new.push(doubt.to_string());
            }
        }
        new
    }

    fn particles(&self) -> Vec<(String, Vec<f64>)> {
        let mut columns: [Vec<f64>; NAMES.len()] = Default::default();
        if let Some(particles) = self.tracker.particles() {
            push_particles(&mut columns, &particles);
        }
        NAMES.map(str::to_owned).into_iter().zip(columns).collect()
    }

    /// The latest row alone.
    fn estimate(&self) -> Estimate {
        Estimate {
            time: vec![self.tracker.time().unwrap_or(f64::NAN)],
            rows: vec![self.tracker.estimate().clone()],
            others: self.others,
            has_tripod: self.has_tripod,
        }
    }
}

/// The numbers of an estimate's only row by the names of columns.
fn to_numbers<'py>(py: Python<'py>, one: &Estimate) -> PyResult<Bound<'py, PyDict>> {
    let numbers = PyDict::new(py);
    for (name, column) in estimate_columns(one) {
        numbers.set_item(name, column[0])?;
    }
    Ok(numbers)
}
