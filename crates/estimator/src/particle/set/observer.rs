//! Observation of a run that does not change it: an [`Observer`] is shown every time step that is
//! solved, and the particles after every row.

use std::fmt::Debug;

use stickslip_dynamics::{Body, Particles, Report, StepInput, StepProblem, StepSolution};

use crate::particle::set::chunk::LANES;
use crate::particle::set::view::ParticleView;

/// One particle's time step.
#[derive(Clone, Copy, Debug)]
pub struct SolvedStep<'a> {
    /// The contact problem.
    pub problem: &'a StepProblem,
    /// The body that the object has each contact with.
    pub bodies: &'a [Body],
    /// Answer of the solver.
    pub solution: &'a StepSolution,
    /// Outcome of the step.
    pub report: Report,
}

/// Observer of the time steps of a run, including substeps, with all
/// contacts that could act. Steps of the particles that learn friction are not shown.
///
/// The steps of a block of 128 particles come in order from one thread. Those of a larger set come
/// from several threads at once, in no fixed order.
pub trait Observer: Debug + Sync {
    /// Takes one step.
    fn on_step(&self, step: &SolvedStep<'_>);

    /// Returns false if [`on_step`](Self::on_step) ignores its steps. They are then not put
    /// together, which takes longer than solving them.
    fn wants_steps(&self) -> bool {
        true
    }

    /// Takes the start of the coming step of up to 128 particles, noise included. Lanes past the
    /// last particle hold any numbers. It is also the place to abandon a run, by
    /// [`std::panic::resume_unwind`].
    fn before_step(&self, input: &StepInput, particles: &[Particles<LANES>]) {
        let _ = (input, particles);
    }

    /// Takes the particles after a row, weighed by its measurements. The first one is the row where
    /// the estimate begins. Rows come in order, from one thread. Only the particle filter has any.
    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        let _ = (row, particles);
    }
}
