//! Looks at a run without changing it: an [`Observer`] is shown every time step that is solved, and
//! the particles after every row.

use std::fmt::Debug;

use stickslip_dynamics::{Body, Particles, Report, StepInput, StepProblem, StepSolution};

use crate::particle::chunk::LANES;
use crate::particle::view::ParticleView;

/// One particle's time step.
#[derive(Clone, Copy, Debug)]
pub struct SolvedStep<'a> {
    /// The contact problem.
    pub problem: &'a StepProblem,
    /// The body that the object has each contact with.
    pub bodies: &'a [Body],
    /// What the solver answered.
    pub solution: &'a StepSolution,
    /// How it ended.
    pub report: Report,
}

/// Is shown the time steps of a run, substeps and steps that are made again included, with all
/// contacts that could act. Steps of the particles that learn friction are not shown.
///
/// The steps of a block of 128 particles come in order from one thread; those of a
/// larger set come from several threads at once, in no fixed order.
pub trait Observer: Debug + Sync {
    /// One step.
    fn on_step(&self, step: &SolvedStep<'_>);

    /// What the coming step of up to 128 particles starts from, noise included; lanes past the last
    /// particle hold any numbers.
    fn before_step(&self, input: &StepInput, particles: &[Particles<LANES>]) {
        let _ = (input, particles);
    }

    /// The particles after a row, weighed by what was measured there; the first one is the row
    /// where the estimate begins. Rows come in order, from one thread. Only the particle filter has
    /// any.
    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        let _ = (row, particles);
    }

    /// The particles that have the friction of the estimate (contact mode, docs/method.md (52)):
    /// after each row in which the camera sees the object, and it moves or nothing has touched it
    /// yet, before [`on_row`](Self::on_row). In rows between, the friction stays as they have it.
    fn on_friction(&self, row: usize, particles: &ParticleView<'_>) {
        let _ = (row, particles);
    }
}
