//! The program `stickslip` in this process: [`program`].

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program with the words of a command line, those after its name; its exit code.
#[pyfunction]
pub fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| stickslip_cli::run(words))
}
