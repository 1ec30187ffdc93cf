//! The solvers of the mixed NCP, cheapest first, behind one certificate.

pub(crate) mod chain;
mod compliant;
mod contact_mode;
mod elimination;
mod exhaustive;
mod fallback;
mod fixed_mode_newton;
mod lane_queue;
mod linearised;
mod newton;
mod newton_block;
mod newton_queue;
mod refiner;
mod smoothed_map;
mod smoothed_path;
pub(crate) mod source;
mod stick_predictor;
mod vector;
