//! Shapes and the narrow phase: where the boundaries of two bodies can touch.

mod cluster;
pub(crate) mod contact;
mod contact_manifold;
mod convex_part;
mod edge;
mod edge_search;
pub(crate) mod narrow_phase;
mod normal_cone;
mod outline;
mod pair;
pub(crate) mod part;
mod piece;
pub(crate) mod placed;
mod polygon;
mod polygon_collider;
mod rounded_vertex;
mod separating_axis;
pub(crate) mod shape;
pub(crate) mod shape_error;
pub(crate) mod transform;
pub(crate) mod vec2;
mod vertex_collider;
