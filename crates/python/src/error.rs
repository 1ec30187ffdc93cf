//! The library's refusals and doubts in Python: the exception [`Error`], the category [`Warning`].

use std::fmt::Display;

use pyo3::create_exception;
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;

create_exception!(
    stickslip,
    Error,
    PyValueError,
    "An input that cannot be used: what was found, the rule, and what to do."
);

create_exception!(
    stickslip,
    Warning,
    PyUserWarning,
    "A reason to doubt a result: what was found, and what to do."
);

/// The exception with the library's words.
pub fn refused(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// Issues warnings at the line that called the package.
pub fn warn(py: Python<'_>, texts: &[String]) -> PyResult<()> {
    if !texts.is_empty() {
        let module = py.import("stickslip._warnings")?;
        module.call_method1("warn", (texts.to_vec(),))?;
    }
    Ok(())
}
