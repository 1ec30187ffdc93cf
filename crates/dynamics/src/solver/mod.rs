//! The solvers of the mixed NCP, cheapest first, behind one certificate.

mod bisection;
pub(crate) mod chain;
mod contact_mode;
mod elimination;
mod fallback;
mod fixed_mode_newton;
mod generator;
mod homotopy;
mod interval;
mod lane_queue;
mod linearised;
mod mode_conditions;
mod mode_curve;
mod mode_search;
mod newton;
mod newton_block;
mod refiner;
mod scalar_ncp;
mod smoothed_map;
mod smoothed_newton;
pub(crate) mod source;
mod stick_predictor;
mod subspace;
mod support_friction;
mod vector;
