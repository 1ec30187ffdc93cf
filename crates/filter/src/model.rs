//! The model of a particle, its motion and the likelihood of observations: [`Model`].

use crate::ensemble::EnsembleShape;
use crate::particles::{Block, BlockMut};
use crate::streams::Draw;

/// Sums over weighted particles.
pub trait WeightedSums: Default + Send {
    /// Back to the sums over no particle; memory is kept.
    fn clear(&mut self);

    /// Adds the sums over other particles, whose weights are `scale` times those that they were
    /// taken with.
    fn add(&mut self, other: &Self, scale: f64);
}

impl WeightedSums for () {
    fn clear(&mut self) {}
    fn add(&mut self, (): &(), _: f64) {}
}

/// A state-space model over blocks of particles.
///
/// Methods work on a block at a time and may run on any thread in any order: their results may
/// depend only on their arguments. All random numbers come from `draw`, with the particle's index
/// in the set ([`BlockMut::particles`]) and draw numbers of the model's choosing; each method has
/// streams of its own.
pub trait Model: Sync {
    /// Input of one step: its length, controls, ...
    type Input: Sync + ?Sized;
    /// One observation.
    type Observation: Sync + ?Sized;
    /// Working memory of one thread, made once. No result may depend on its content at the start of
    /// a call: a thread takes any block. State of a particle belongs in a column.
    type Scratch: Send;
    /// The sums that the step's estimate is made of; `()` where none is needed.
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
    /// A model whose proposal is not its transition adds the log-ratio of the two here (carried in
    /// a column). A likelihood normalised as a density makes
    /// [`WeightUpdate::Weighed`](crate::WeightUpdate) an evidence.
    fn log_likelihood(&self, observation: &Self::Observation, block: &Block<'_>, out: &mut [f64]);

    /// Writes the weighted sums over one block.
    fn sum(&self, input: &Self::Input, block: &Block<'_>, weights: &[f64], sums: &mut Self::Sums);

    /// Returns true if a resampling may copy particle `i` of a block; by default any. A particle
    /// whose last move is unknown may not be copied. If none of positive weight may be copied, all
    /// may.
    fn may_be_copied(&self, _block: &Block<'_>, _i: usize) -> bool {
        true
    }

    /// Returns true if no particle explains the observation, given the largest log-likelihood among
    /// particles of positive weight. A largest value of -inf is always a collapse.
    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        best_log_likelihood == f64::NEG_INFINITY
    }

    /// Writes the log-likelihood of the part of the observation that
    /// [`reinitialise`](Self::reinitialise) draws the particles around, and that
    /// [`moves`](Self::moves) them; all of it by default.
    ///
    /// Where the whole log-likelihood indicates a collapse and this part does not, the particles
    /// stay: no reinitialising makes, say, a false alarm of another sensor likelier.
    fn resetting_log_likelihood(
        &self,
        observation: &Self::Observation,
        block: &Block<'_>,
        out: &mut [f64],
    ) {
        self.log_likelihood(observation, block, out);
    }

    /// Returns true if the model wants
    /// [`StepReport::resetting_log_evidence`](crate::StepReport::resetting_log_evidence): how well
    /// the particles expected that part of an observation. By default it does not.
    fn judges_resetting(&self, _observation: &Self::Observation) -> bool {
        false
    }

    /// Quantities that observations may move, in addition to weighing; by default none.
    fn ensemble(&self) -> EnsembleShape {
        EnsembleShape::default()
    }

    /// Returns true if an observation may move the quantities of [`ensemble`](Self::ensemble). The
    /// part of it that moves is that of
    /// [`resetting_log_likelihood`](Self::resetting_log_likelihood), and about normal: ln of its
    /// likelihood is −½ the sum of the squares of errors over their noise, up to a constant.
    fn moves(&self, _observation: &Self::Observation) -> bool {
        false
    }

    /// Share, 0 to 1, of an observation that moves particles even where weighing by it would leave
    /// enough of them; by default none. Particles that lie far from it stay then, and are weighed
    /// by all of it.
    ///
    /// Weighing by many observations that each say little leaves few particles all the same. Where
    /// nothing disturbs these, they do not change.
    fn least_moved(&self, _observation: &Self::Observation) -> f64 {
        0.0
    }

    /// Probability that an observation is not wrong, given ln of the mean likelihood of the part
    /// that moves; by default 1. As much of [`least_moved`](Self::least_moved) counts.
    fn plausibility(&self, _observation: &Self::Observation, _log_evidence: f64) -> f64 {
        1.0
    }

    /// Writes columns of [`BLOCK`](crate::BLOCK) numbers: each quantity that may be moved, then
    /// each error, then the standard deviation of each error's noise by the particle's own
    /// estimate. An error is the value that a particle expects less the observed one. Places past
    /// the block's last particle hold any finite number.
    fn read_ensemble(&self, _observation: &Self::Observation, _block: &Block<'_>, _to: &mut [f64]) {
    }

    /// Takes the quantities back into the block.
    fn write_ensemble(&self, _from: &[f64], _block: &mut BlockMut<'_>) {}

    /// Redraws particles around the observation after a collapse; the columns hold the propagated
    /// particles, resampled by their weights before the observation. The observation is not weighed
    /// again.
    fn reinitialise(&self, observation: &Self::Observation, draw: Draw, block: &mut BlockMut<'_>);
}
