//! Independent oracles for the tests of the other crates. Nothing here shares code with the solver, only the problem's types.
//!
//! - [`residual_si`]: the certificate of a step, by a second route.
//! - [`Block`]: closed forms of the time-stepping scheme.
//! - [`data_root`]: where recorded experiments lie.

mod closed_form;
mod data;
mod residual;

pub use closed_form::{Block, Stop};
pub use data::data_root;
pub use residual::{ResidualRow, residual_rows_si, residual_si};
