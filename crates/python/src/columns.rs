//! Columns of numbers by name, as dicts of NumPy arrays: [`Columns`], [`to_dict`].

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stickslip_formats::NamedColumns;

use crate::error::refused;

/// Columns that Python holds, borrowed as long as this lives.
pub struct Columns<'py>(Vec<(String, PyReadonlyArray1<'py, f64>)>);

impl<'py> Columns<'py> {
    /// The arrays of a dict: one dimension, contiguous, float64.
    pub fn of(dict: &Bound<'py, PyDict>) -> PyResult<Self> {
        let column = |(name, array): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            Ok((name.extract::<String>()?, array.extract()?))
        };
        dict.iter().map(column).collect::<PyResult<_>>().map(Self)
    }

    /// The columns for the library.
    pub fn named(&self) -> PyResult<NamedColumns<'_>> {
        let mut columns = Vec::with_capacity(self.0.len());
        for (name, array) in &self.0 {
            columns.push((name.clone(), array.as_slice()?));
        }
        NamedColumns::new(columns).map_err(refused)
    }
}

/// A dict of arrays, in the order given.
pub fn to_dict(py: Python<'_>, columns: Vec<(String, Vec<f64>)>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, column) in columns {
        dict.set_item(name, PyArray1::from_vec(py, column))?;
    }
    Ok(dict)
}
