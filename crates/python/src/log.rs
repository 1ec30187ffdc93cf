//! Logs: [`read_log`], [`write_log`], and the log that a dict of columns holds, [`log_of`].

use std::io::Cursor;

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use stickslip::Log;
use stickslip_formats::{LogWarning, Topics, log_columns, log_of_columns};

use crate::columns::{Columns, to_dict};
use crate::error::refused;

/// The columns of a log file's bytes: MCAP where `name` ends so, else CSV.
#[pyfunction]
pub fn read_log<'py>(py: Python<'py>, data: &[u8], name: &str) -> PyResult<Bound<'py, PyDict>> {
    let read = py.detach(|| {
        if name.to_ascii_lowercase().ends_with(".mcap") {
            let read =
                stickslip_formats::read_log_mcap(Cursor::new(data), name, &Topics::default());
            read.map_err(|error| error.to_string())
        } else {
            stickslip_formats::read_log(data, name).map_err(|error| error.to_string())
        }
    });
    let (log, warnings) = read.map_err(refused)?;
    warn(py, &warnings)?;
    to_dict(py, log_columns(&log))
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
    warn(columns.py(), &warnings)?;
    Ok(log)
}

fn warn(py: Python<'_>, warnings: &[LogWarning]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    let module = py.import("warnings")?;
    warnings.iter().try_for_each(|warning| {
        module.call_method1("warn", (warning.to_string(), &category, 3))?;
        Ok(())
    })
}
