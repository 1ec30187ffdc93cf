//! The solvers of the mixed NCP, cheapest first, behind one certificate.

mod balance;
mod certifier;
pub(crate) mod chain;
mod compliant;
mod contact_mode;
mod elimination;
mod enclosure;
mod fallback;
mod fixed_mode_newton;
mod generator;
mod interval;
mod lane_queue;
mod limit_surface;
mod linearised;
mod load;
mod mode_conditions;
mod mode_curve;
mod mode_line;
mod mode_search;
mod newton;
mod newton_block;
#[cfg(test)]
mod numbers;
mod piece_search;
mod plane_region;
mod redundant_line;
mod redundant_plane;
mod refiner;
mod relief;
mod scalar_ncp;
mod smoothed_map;
mod smoothed_path;
pub(crate) mod source;
mod stick_predictor;
mod subspace;
mod support_friction;
mod vector;
