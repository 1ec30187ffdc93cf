//! The solvers of the mixed NCP, cheapest first, behind one certificate.

pub(crate) mod chain;
mod elimination;
mod fallback;
mod fixed_modes;
mod lane_queue;
mod linearised;
mod mode_rows;
mod mode_search;
mod newton;
mod newton_block;
mod path;
mod smoothed;
mod smoothed_path;
pub(crate) mod source;
mod subspace;
mod support_friction;
