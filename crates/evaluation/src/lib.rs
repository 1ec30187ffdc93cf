//! Evaluation: the compared methods ([`Variant`]), one scored run of it ([`ScoredRun`]), statistics
//! over seeds, simulated experiments ([`Simulation`]) and the paper's evaluation ([`paper`]).
//!
//! Nothing here opens a file or reads a clock. The same arguments give the same bits.

mod belief;
mod learned_friction;
pub mod paper;
mod run;
mod score;
mod simulation;
mod statistics;
mod variant;

pub use belief::{Belief, PIT_BINS};
pub use learned_friction::{LearnedParameter, LearningFriction};
pub use run::{RunConditions, ScoredRun};
pub use score::{Reference, Scores, score};
pub use simulation::{
    PUSHER_MEMORY, Physics, REPEATS, Seeds, Simulation, SimulationError, SimulationOptions,
};
pub use statistics::{Band, Direction, PairedDifference};
pub use stickslip::quantile;
pub use variant::Variant;
