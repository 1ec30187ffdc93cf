//! The Python module `stickslip._native`: the library on NumPy arrays.
//!
//! It maps arguments to the library's types and results to arrays, and holds no logic of its own;
//! the package that Python users see, with its documentation, is in `python/stickslip/`. Columns of
//! logs and estimates go in and out under the names that they have in files. The library works
//! without the interpreter's lock, on threads of its own.

mod columns;
mod error;
mod filter;
mod fit;
mod given;
mod log;
mod long_call;
mod page;
mod particles;
mod program;
mod rollout;
mod run_options;
mod scene;
mod score;
mod simulate;
mod threads;
mod tracker;

use pyo3::prelude::*;

/// The library behind the package `stickslip`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add("Warning", module.py().get_type::<error::Warning>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<tracker::Tracker>()?;
    module.add_function(wrap_pyfunction!(log::read_log, module)?)?;
    module.add_function(wrap_pyfunction!(log::write_log, module)?)?;
    module.add_function(wrap_pyfunction!(log::bag_info, module)?)?;
    module.add_function(wrap_pyfunction!(log::log_files, module)?)?;
    module.add_function(wrap_pyfunction!(filter::check, module)?)?;
    module.add_function(wrap_pyfunction!(filter::filter, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(page::comparison_page, module)?)?;
    module.add_function(wrap_pyfunction!(page::player, module)?)?;
    module.add_function(wrap_pyfunction!(page::report, module)?)?;
    module.add_function(wrap_pyfunction!(particles::particles, module)?)?;
    module.add_function(wrap_pyfunction!(program::program, module)?)?;
    module.add_function(wrap_pyfunction!(rollout::rollout, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(score::score, module)?)
}
