//! What a particle is, how it moves and what it makes of an observation.

use crate::{Block, BlockMut, Draw};

/// Sums over weighted particles.
pub trait WeightedSums: Default + Send {
    /// Back to the sums over no particle; memory is kept.
    fn clear(&mut self);

    /// Adds the sums over other particles, whose weights are `share` times those that they were
    /// taken with.
    fn add(&mut self, other: &Self, share: f64);
}

impl WeightedSums for () {
    fn clear(&mut self) {}
    fn add(&mut self, (): &(), _: f64) {}
}

/// A state-space model over blocks of particles.
///
/// Methods work on a block at a time and may run on any thread in any order: what they write may
/// depend only on their arguments. All random numbers come from `draw`, with the particle's index
/// in the set ([`BlockMut::particles`]) and draw numbers of the model's choosing; each method has
/// streams of its own.
pub trait Model: Sync {
    /// What is known of one step: its length, controls, ...
    type Input: Sync + ?Sized;
    /// One observation.
    type Observation: Sync + ?Sized;
    /// Working memory of one thread, made once. It may remember nothing that a result depends on: a
    /// thread takes up any block. What belongs to a particle is a column.
    type Scratch: Send;
    /// What the particles amount to after a step; `()` where nobody asks.
    type Sums: WeightedSums;

    /// The number of columns, at least 1.
    fn columns(&self) -> usize;

    /// The working memory of one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Draws the particles at the start. All columns are zero before.
    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>);

    /// Moves the particles over one step, process noise included.
    fn propagate(
        &self,
        input: &Self::Input,
        draw: Draw,
        block: &mut BlockMut<'_>,
        scratch: &mut Self::Scratch,
    );

    /// Writes the log-likelihood of the observation given each particle: finite or -inf, never NaN.
    ///
    /// A model that proposes from something else than its transition adds the log-ratio of the two
    /// here (carried in a column). A likelihood normalised as a density makes
    /// [`Weighing::Weighed`](crate::Weighing) an evidence.
    fn log_likelihood(&self, observation: &Self::Observation, block: &Block<'_>, out: &mut [f64]);

    /// Writes the sums over one block that has made a step, while it is at hand.
    fn sum(&self, input: &Self::Input, block: &Block<'_>, weights: &[f64], sums: &mut Self::Sums);

    /// Whether no particle explains the observation, given the largest log-likelihood among
    /// particles of positive weight. A largest value of -inf is always a collapse.
    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        best_log_likelihood == f64::NEG_INFINITY
    }

    /// Writes the part of the log-likelihood that a redraw can raise; all of it unless the model
    /// says otherwise.
    ///
    /// Asked for only where the whole seems to be a collapse: an observation that another sensor
    /// makes unlikely, as a false alarm does, is no reason to draw the particles anew.
    fn redrawn_log_likelihood(
        &self,
        observation: &Self::Observation,
        block: &Block<'_>,
        out: &mut [f64],
    ) {
        self.log_likelihood(observation, block, out);
    }

    /// Draws particles anew around the observation after a collapse; the columns hold the
    /// propagated particles, resampled by their weights before the observation. The observation is
    /// not weighed again.
    fn redraw(&self, observation: &Self::Observation, draw: Draw, block: &mut BlockMut<'_>);
}
