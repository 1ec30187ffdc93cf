//! The step to one row, as the model gets it: [`StepPlan`].

use stickslip_dynamics::{StepInput, Twist};

use crate::particle::observation::Observation;
use crate::particle::resting_pose::RestingPose;
use crate::particle::sums::Reference;

/// Whether the friction parameters take a random step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterNoise {
    /// β̂ = β + w_β τ(β).
    Drawn,
    /// β̂ = β, while the camera is occluded.
    Frozen,
}

/// A pusher that nobody sees, and that may move the object (contact mode).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnseenPusher {
    /// Its last twist.
    pub twist: Twist,
    /// Whether it would have reached an object that is hidden, too, had it gone on like that.
    pub reached: bool,
    /// Whether it does so in this step.
    pub reaches: bool,
}

/// The step to one row.
#[derive(Clone, Debug)]
pub struct StepPlan {
    /// Substeps; their lengths sum to the step's.
    pub substeps: Vec<StepInput>,
    /// Whether the pusher moves.
    pub driven: bool,
    /// Whether the parameters take a random step.
    pub parameter_noise: ParameterNoise,
    /// Steps since the one that drew the noise which this step shares with it; 0 where it draws its
    /// own.
    pub noise_age: u64,
    /// The pusher's velocity (m/s), where it has been the same for as long as the camera may lag
    /// (contact mode).
    pub steady: Option<[f64; 2]>,
    /// The pusher, where nobody knows where it is, and it may carry the object along (contact
    /// mode).
    pub unseen_pusher: Option<UnseenPusher>,
    /// Whether it has just come back into view (contact mode).
    pub pusher_is_back: bool,
    /// History slot for the pose at the end of the step, where past poses are kept.
    pub slot: usize,
    /// What weighed the particles at the row before, of which they learn how noisy the camera is;
    /// without a pose in paper mode.
    pub seen: Observation,
    /// Where the object is if nothing has moved it yet, where the row before told more of that
    /// (contact mode).
    pub resting: Option<RestingPose>,
    /// Tactile readings at the end of the step, one per sensor.
    pub tactile: Vec<Option<bool>>,
    /// Values near the estimate, about which sums are taken.
    pub reference: Reference,
    /// Whether the step is made again, (42).
    pub second_try: bool,
}

impl StepPlan {
    /// Becomes a copy of `other`, in the memory that it has.
    pub(crate) fn overwrite(&mut self, other: &Self) {
        let Self {
            substeps,
            driven,
            parameter_noise,
            noise_age,
            steady,
            unseen_pusher,
            pusher_is_back,
            slot,
            seen,
            resting,
            tactile,
            reference,
            second_try,
        } = other;
        self.substeps.clone_from(substeps);
        self.tactile.clone_from(tactile);
        self.seen.overwrite(seen);
        (self.driven, self.parameter_noise) = (*driven, *parameter_noise);
        (self.noise_age, self.steady) = (*noise_age, *steady);
        (self.unseen_pusher, self.slot) = (*unseen_pusher, *slot);
        self.pusher_is_back = *pusher_is_back;
        (self.resting, self.reference) = (*resting, *reference);
        self.second_try = *second_try;
    }

    /// Length of the step (s).
    pub(crate) fn duration(&self) -> f64 {
        self.substeps.iter().map(|step| step.h).sum()
    }

    /// Whether the camera shows nothing.
    #[inline(always)]
    pub(crate) fn is_dark(&self) -> bool {
        self.parameter_noise == ParameterNoise::Frozen
    }

    /// Whether what a particle takes as known changes a little, so that copies differ: while the
    /// camera looks, and in the dark while the pusher moves (contact mode). At rest nothing would
    /// tell them apart.
    pub(crate) fn unknowns_wander(&self) -> bool {
        self.driven || !self.is_dark()
    }

    /// Whether the camera sees where the object rests: what keeps it from the poses that are seen
    /// is the rig.
    pub(crate) fn shows_rest(&self) -> bool {
        !self.driven && self.unseen_pusher.is_none() && !self.is_dark()
    }

    /// No step at all.
    pub(crate) fn none(reference: Reference) -> Self {
        Self {
            substeps: Vec::new(),
            driven: false,
            parameter_noise: ParameterNoise::Frozen,
            noise_age: 0,
            steady: None,
            unseen_pusher: None,
            pusher_is_back: false,
            slot: 0,
            seen: Observation::default(),
            resting: None,
            tactile: Vec::new(),
            reference,
            second_try: false,
        }
    }
}
