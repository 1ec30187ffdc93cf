//! Logs: [`read_log`], [`bag_info`], [`log_files`], [`write_log`], and the log that a dict of
//! columns holds, [`log_of`]; the truth likewise, [`truth_of`].

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use stickslip::Log;
use stickslip_formats::{
    BagOptions, LogWarning, TopicMapping, Topics, Truth, log_columns, log_of_columns, read_mounts,
    truth_of_columns,
};

use crate::columns::{Columns, to_dict};
use crate::error::{refused, warn};
use crate::long_call::left_behind;
use crate::scene::Scene;

/// The columns of the log at a path; of a bag by the scene's tags and by topics, as `KEY=TOPIC`.
#[pyfunction]
#[pyo3(signature = (path, scene = None, topics = Vec::new()))]
pub fn read_log<'py>(
    py: Python<'py>,
    path: PathBuf,
    scene: Option<&Bound<'py, Scene>>,
    topics: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let mappings = topics.iter().map(|text| text.parse());
    let mappings: Vec<TopicMapping> = mappings.collect::<Result<_, _>>().map_err(refused)?;
    let mut options = BagOptions {
        topics: Topics::new(mappings).map_err(refused)?,
        ..BagOptions::default()
    };
    if let Some(scene) = scene.map(Bound::get) {
        options.mounts = read_mounts(&scene.text, &scene.name).map_err(refused)?;
        options.touch_force = scene.setup.tactile.touch_force;
    }
    let read = left_behind(py, move || stickslip_cli::read_log_at(&path, &options));
    let (log, warnings) = read?.map_err(refused)?;
    warn(py, &warnings)?;
    to_dict(py, log_columns(&log))
}

/// The description of the bag at a path, as JSON.
#[pyfunction]
pub fn bag_info(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let described = left_behind(py, move || stickslip_cli::bag_info(&path));
    let (info, warnings) = described?.map_err(refused)?;
    warn(py, &warnings)?;
    Ok(info)
}

/// The files of the log at a path.
#[pyfunction]
pub fn log_files(path: PathBuf) -> PyResult<Vec<PathBuf>> {
    stickslip_cli::log_files(&path).map_err(refused)
}

/// The bytes of log.csv for columns of a log.
#[pyfunction]
pub fn write_log<'py>(
    py: Python<'py>,
    columns: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyBytes>> {
    let log = log_of(columns)?;
    let mut bytes = Vec::new();
    stickslip_formats::write_log(&mut bytes, &log)?;
    Ok(PyBytes::new(py, &bytes))
}

/// The log that a dict of columns holds.
pub fn log_of(columns: &Bound<'_, PyDict>) -> PyResult<Log> {
    let held = Columns::of(columns)?;
    let (log, warnings) = log_of_columns(&held.named()?, "log").map_err(refused)?;
    let warnings: Vec<String> = warnings.iter().map(LogWarning::to_string).collect();
    warn(columns.py(), &warnings)?;
    Ok(log)
}

/// The truth that a dict of columns holds.
pub fn truth_of(columns: &Bound<'_, PyDict>) -> PyResult<Truth> {
    let held = Columns::of(columns)?;
    truth_of_columns(&held.named()?).map_err(refused)
}
