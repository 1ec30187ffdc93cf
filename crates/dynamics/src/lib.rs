//! Planar frictional contact dynamics of one pushed object.

mod condensed;
mod drag;
mod feature;
mod homotopy;
mod lanes;
mod modes;
mod narrow;
mod ncp;
mod newton;
mod outline;
mod overlap;
mod plane;
mod polish;
mod problem;
mod rows;
mod scene;
mod se2;
mod separation;
mod shape;
mod shape_error;
mod smooth;
mod solid;
mod solver;
mod step;
mod subspace;

pub use lanes::{Lanes, Mask};
pub use narrow::{Gap, Placed, narrow_phase};
pub use ncp::{ContactRow, FootRow, Impulses, Ncp};
pub use problem::{ContactPoint, Foot, Stall, StepProblem, StepSolution};
pub use scene::{Feet, Fixel, Friction, Object, Pusher, Scene};
pub use se2::{Pose, Twist, Wrench};
pub use shape::{Part, Shape};
pub use shape_error::ShapeError;
pub use solver::{Outcome, Report, Route, Solver, TOLERANCE, solve};
pub use step::{Body, Dynamics, Particle, PusherMotion, StepInput, StepWork, WarmStart};
