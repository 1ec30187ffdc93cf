//! Planar frictional contact dynamics of one pushed object.

mod problem;
mod scene;
mod se2;
mod shape;

pub use problem::{ContactPoint, Foot, Stall, StepProblem, StepSolution};
pub use scene::{Feet, Fixel, Friction, Object, Pusher, Scene};
pub use se2::{Pose, Twist, Wrench};
pub use shape::{Part, Shape};
