//! Shapes and the narrow phase: where the boundaries of two bodies can touch.

mod cluster;
pub(crate) mod contact;
mod edge_search;
mod ellipse;
mod ellipse_pair;
mod feature;
pub(crate) mod narrow_phase;
mod outline;
mod pair;
mod part;
mod separating_axis;
pub(crate) mod shape;
pub(crate) mod shape_error;
pub(crate) mod transform;
pub(crate) mod vec2;
