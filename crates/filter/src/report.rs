//! Report of a filter step: [`StepReport`].

/// Report of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct StepReport {
    /// The effective sample size at the end of the step, in [1, N].
    pub effective_sample_size: f64,
    /// True if the step began with resampling, or the number of particles changed before it.
    pub resampled: bool,
    /// Effect of the observation on the weights.
    pub weight_update: WeightUpdate,
    /// ln of the mean likelihood, by the weights before, of the part of the observation that
    /// [`reinitialise`](crate::Model::reinitialise) draws the particles around; where the model
    /// [judges](crate::Model::judges_resetting) it.
    pub resetting_log_evidence: Option<f64>,
}

impl StepReport {
    /// Returns true if no particle explained the observation.
    pub fn collapsed(&self) -> bool {
        matches!(self.weight_update, WeightUpdate::Collapsed { .. })
    }
}

/// Effect of a step's observation on the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub enum WeightUpdate {
    /// There was no observation; the weights are unchanged.
    Unobserved,
    /// The weights were multiplied by the observation's likelihood.
    Weighed {
        /// ln p(observation | observations before), as the particles estimate it.
        log_evidence: f64,
    },
    /// No particle explained the observation; the particles were reinitialised around it, with
    /// equal weights.
    Collapsed {
        /// The largest log-likelihood that a particle gave to the part of the observation that
        /// reinitialising can explain.
        best_log_likelihood: f64,
    },
}
