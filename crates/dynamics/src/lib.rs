//! Planar frictional contact dynamics of one pushed object.

mod condensed;
mod drag;
mod homotopy;
mod modes;
mod lanes;
mod ncp;
mod newton;
mod polish;
mod problem;
mod rows;
mod scene;
mod se2;
mod shape;
mod solver;

pub use lanes::{Lanes, Mask};
pub use ncp::{ContactRow, FootRow, Impulses, Ncp};
pub use problem::{ContactPoint, Foot, Stall, StepProblem, StepSolution};
pub use scene::{Feet, Fixel, Friction, Object, Pusher, Scene};
pub use se2::{Pose, Twist, Wrench};
pub use shape::{Part, Shape};
pub use solver::{Outcome, Report, Route, Solver, TOLERANCE};
