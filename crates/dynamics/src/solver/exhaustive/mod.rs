//! Exhaustive search over contact modes, the last solver: it finds a solution, or proves that there
//! is none.
//!
//! ```text
//!  mode_search     every subset of at most four generators, in rounds
//!    │    │
//!    │    └── open_planes, plane_region: what the inequalities leave of a plane; mostly nothing
//!    ▼
//!  mode_line   mode_curve   redundant_line   redundant_plane
//!    │     velocities that a subset of generators allows; a point needs none of these
//!    ▼
//!  piece_search    halves them: a piece is excluded, or its middle tried, or halved again
//!    │         │
//!    │         └── excludes a piece
//!    │               mode_conditions          open gaps, opposed slips, the limit on speed
//!    │                 └── balance ── load    no impulses balance any load of the piece
//!    │               enclosure ── interval    bounds on its velocities
//!    ▼
//!  certifier       judges a candidate, within a limit on work
//!  relief          finds smaller impulses for a solution
//!
//!  scalar_ncp: the problem.  generator: edges of friction cones, and the stall pair.
//!  support_friction ── limit_surface: the object on its feet alone.
//!  subspace: points, lines and dual bases.
//! ```
//!
//! [`mode_search`] states the theorem, `docs/decisions/001-solver-chain.md` why the search is
//! needed.

mod balance;
pub(super) mod certifier;
mod enclosure;
mod generator;
mod interval;
mod limit_surface;
mod load;
mod mode_conditions;
mod mode_curve;
mod mode_line;
pub(super) mod mode_search;
#[cfg(test)]
mod numbers;
mod open_planes;
mod piece_search;
mod plane_region;
mod redundant_line;
mod redundant_plane;
pub(super) mod relief;
pub(super) mod scalar_ncp;
mod subspace;
mod support_friction;
