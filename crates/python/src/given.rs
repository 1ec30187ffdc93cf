//! Values that Python gives as a dict, refused with their name and value where they are of a wrong
//! type: [`Given`].

use pyo3::prelude::*;

use crate::error::refused;

/// The items of a dict.
pub struct Given<T>(pub T);

impl<'a, 'py, T: FromPyObject<'a, 'py>> FromPyObject<'a, 'py> for Given<T> {
    type Error = PyErr;

    fn extract(dict: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let items = dict.extract::<T>();
        items.map(Self).map_err(|error| named(error.into(), dict))
    }
}

/// The reason why an item of `dict` cannot be used, with the item.
fn named(error: PyErr, dict: Borrowed<'_, '_, PyAny>) -> PyErr {
    let py = dict.py();
    let mut words = error.value(py).to_string();
    let item = words.rsplit('.').next().unwrap_or_default().to_owned();
    let mut cause = error.cause(py);
    while let Some(error) = cause {
        words = error.value(py).to_string();
        cause = error.cause(py);
    }
    let value = dict.get_item(&item).and_then(|value| value.repr());
    match value {
        Ok(value) => refused(format!("{item} is {value}: {words}")),
        Err(_) => refused(words),
    }
}

/// A tactile reading: False or True, 0 or 1.
#[derive(Clone, Copy)]
pub struct Reading(pub bool);

impl<'a, 'py> FromPyObject<'a, 'py> for Reading {
    type Error = PyErr;

    fn extract(reading: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(touched) = reading.extract::<bool>() {
            return Ok(Self(touched));
        }
        match reading.extract::<f64>() {
            Ok(0.0) => Ok(Self(false)),
            Ok(1.0) => Ok(Self(true)),
            _ => Err(refused(format!(
                "a reading is {}; it must be 0 or 1, False or True, or None",
                reading.repr()?
            ))),
        }
    }
}
