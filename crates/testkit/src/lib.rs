//! Independent oracles for the tests of the other crates. Nothing here shares code with the solver,
//! only the problem's types.
//!
//! - [`residual_si`]: the certificate of a step, by a second route.
//! - [`enumerate_modes`]: all solutions of a small step, by trying every contact mode.
//! - [`cone_program_step`]: the solution where no contact has friction, by convex optimisation.
//! - [`impulses_for_twist`]: whether a twist is a solution, and by which impulses.
//! - [`gap_margin`], [`may_jam`], [`is_solvable`]: whether a step certainly has no solution, or
//!   certainly has one.
//! - [`speed_limit`], [`is_sought`]: highest speed of a solution that is sought;
//!   [`judged_residual`]: residual and speed at once.
//! - [`Block`]: closed forms of the time-stepping scheme.
//! - [`Corpus`]: a fixed sequence of hard random problems.
//! - [`survey`]: results of the solver on it.
//! - [`hard_steps`]: steps that a solver once failed on, or took long for.
//! - [`pushed_scene`]: a scene with given shapes.
//! - [`data_root`]: folder of recorded experiments.
//! - [`judge`]: outcome of one problem; [`SplitMix64`]: random numbers.
//! - [`cross`], [`dot`], [`left`]: vectors in the plane.

mod block;
mod cone;
mod conic_program;
mod corpus;
mod data;
mod hard_steps;
mod hull;
mod impulses;
mod jam;
mod manufactured;
mod mode_equations;
mod modes;
mod problem_builder;
mod residual;
mod rng;
mod scaled_problem;
mod scenes;
mod speed_limit;
mod survey;
mod vector;

pub use block::{Block, Stop};
pub use cone::{cone_program_step, cone_program_twist};
pub use corpus::{Corpus, Family};
pub use data::data_root;
pub use hard_steps::{HardStep, hard_steps};
pub use impulses::impulses_for_twist;
pub use jam::{gap_margin, is_solvable, may_jam};
pub use modes::enumerate_modes;
pub use residual::{ResidualRow, residual_rows_si, residual_si};
pub use rng::{SplitMix64, mix};
pub use scenes::{disc, fixels, pushed_scene, square};
pub use speed_limit::{is_sought, judged_residual, speed_limit};
pub use survey::{Tally, judge, survey};
pub use vector::{cross, dot, left};
