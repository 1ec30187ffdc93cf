//! Planar frictional contact dynamics of one pushed object.

mod assembly;
mod block_problems;
mod by_lane;
mod compiled_step;
mod contact_state;
mod feet;
mod friction;
mod geometry;
mod input;
mod kept_lanes;
mod ncp;
mod particles;
mod prepared_scene;
mod rollout;
mod scene;
mod se2;
mod solved_contact;
mod solver;
mod start;
mod stated_problem;
mod step;
mod step_work;
mod support;

pub use compiled_step::CompiledStep;
pub use friction::Friction;
pub use geometry::contact::Gap;
pub use geometry::narrow_phase::narrow_phase;
pub use geometry::part::Part;
pub use geometry::placed::Placed;
pub use geometry::shape::Shape;
pub use geometry::shape_error::ShapeError;
pub use input::{Body, FingerMotion, MOST_FINGERS, Offsets, PusherMotion, StepInput};
pub use ncp::problem::{ContactPoint, Foot, StepProblem, StepSolution};
pub use ncp::report::{Outcome, Report, Route, TOLERANCE};
pub use ncp::rows::{ContactRow, FootRow, Ncp};
pub use ncp::unknowns::Unknowns;
pub use particles::{ContactImpulse, Particle, Particles, WarmStart};
pub use rollout::{
    ROLLOUT_BLOCK, Rollout, RolloutArrays, RolloutEnd, RolloutError, RolloutStart, RolloutWork,
};
pub use scene::{Feet, Fixel, Object, Pusher, Scene};
pub use se2::{Pose, Twist, Wrench};
pub use solved_contact::SolvedContact;
pub use solver::chain::{Solver, solve, solve_from};
pub use start::{SpeedProfile, Start};
pub use step::Dynamics;
pub use step_work::StepWork;
pub use stickslip_lanes::{Lanes, Level, Mask, on_widest, sin_cos};
pub use support::Support;
