//! The mixed nonlinear complementarity problem of one time step, its unknowns and its residual.

pub(crate) mod max_abs;
pub(crate) mod natural_map;
pub(crate) mod problem;
pub(crate) mod report;
pub(crate) mod rows;
pub(crate) mod unknowns;
