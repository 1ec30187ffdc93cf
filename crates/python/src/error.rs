//! The library's refusals as Python's exception: [`Error`].

use std::fmt::Display;

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    stickslip,
    Error,
    PyValueError,
    "An input that cannot be used: what was found, the rule, and what to do."
);

/// The exception with the library's words.
pub fn refused(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}
