//! Plan of the step to one row, as the model gets it: [`StepPlan`].

use stickslip_dynamics::{PusherMotion, StepInput, Twist};

use crate::particle::estimate::sums::Reference;
use crate::particle::sensor::observation::Observation;
use crate::tuning::TOUCHING;

/// Pair of normal numbers of objects that an unseen pusher carries: behind those of all substeps.
pub(crate) const UNSEEN_PAIR: u32 = 1 << 20;

/// Random step of the friction parameters, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterNoise {
    /// β̂ = β + w_β τ(β).
    Drawn,
    /// β̂ = β, while the camera is occluded.
    Frozen,
}

/// A pusher that is not seen and may move the object (robust model).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnseenPusher {
    /// Its last twist, of a hand the mean of its fingers'.
    pub twist: Twist,
    /// Speed of its fastest finger then (m/s).
    pub speed: f64,
    /// True if it would have reached a hidden object, had it gone on like that.
    pub reached: bool,
    /// True if it does so in this step.
    pub reaches: bool,
}

/// Drive of the step to a row by the pusher.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'a> {
    /// Substeps; their lengths sum to the step's.
    pub substeps: &'a [StepInput],
    /// True if the pusher moves.
    pub moves: bool,
    /// True if the pusher is not seen.
    pub unseen: bool,
    /// True if `moves` knows the rows that follow, so that a stop shows when it begins.
    pub smoothed: bool,
}

impl<'a> Drive<'a> {
    /// The drive of these substeps; the pusher is seen if the last substep has it.
    pub fn new(substeps: &'a [StepInput], moves: bool) -> Self {
        Self {
            substeps,
            moves,
            unseen: substeps.last().is_some_and(|step| step.pusher.is_none()),
            smoothed: false,
        }
    }
}

/// Plan of the step to one row.
#[derive(Clone, Debug)]
pub struct StepPlan {
    /// Substeps; their lengths sum to the step's.
    pub substeps: Vec<StepInput>,
    /// True if the pusher moves.
    pub driven: bool,
    /// Random step of the parameters, or none.
    pub parameter_noise: ParameterNoise,
    /// Number of steps since the one that drew the noise of this step; 0 if it draws its own.
    pub noise_age: u64,
    /// The pusher, if its place is not known and it may carry the object along (robust model).
    pub unseen_pusher: Option<UnseenPusher>,
    /// True if the pusher has just come back into view (robust model).
    pub pusher_is_back: bool,
    /// Motion in which the pusher would have gone on, if it stops at the end of the step (robust
    /// model). Only its twists count.
    pub stopped: Option<PusherMotion>,
    /// True if the pusher's poses are intended, not measured: a drive that yields stays behind them
    /// as far as it does.
    pub intended: bool,
    /// True if neither random force nor a random step of the unknowns disturbs this step.
    pub undisturbed: bool,
    /// Gap up to which bodies touch (m), (22).
    pub touching: f64,
    /// History slot for the pose at the end of the step, where past poses are kept.
    pub slot: usize,
    /// Observation that weighed the particles at the row before, from which they learn the camera's
    /// noise; without a pose in the paper's model.
    pub seen: Observation,
    /// Tactile readings at the end of the step, one per sensor.
    pub tactile: Vec<Option<bool>>,
    /// Force of the pusher over the step (N), where it was measured (robust model).
    pub force: Option<[f64; 2]>,
    /// Values near the estimate, about which sums are taken.
    pub reference: Reference,
}

impl StepPlan {
    /// Length of the step (s).
    pub(crate) fn duration(&self) -> f64 {
        self.substeps.iter().map(|step| step.h).sum()
    }

    /// Returns true if the camera shows nothing.
    #[inline(always)]
    pub(crate) fn is_dark(&self) -> bool {
        self.parameter_noise == ParameterNoise::Frozen
    }

    /// Returns true if the pusher stands and the camera shows nothing.
    pub(crate) fn rests_unseen(&self) -> bool {
        !self.driven && self.is_dark()
    }

    /// Returns true if the pusher is tracked and stands: nothing slides then.
    pub(crate) fn pusher_stands(&self) -> bool {
        !self.driven && self.unseen_pusher.is_none()
    }

    /// A plan of no step at all.
    pub(crate) fn none(reference: Reference) -> Self {
        Self {
            substeps: Vec::new(),
            driven: false,
            parameter_noise: ParameterNoise::Frozen,
            noise_age: 0,
            unseen_pusher: None,
            pusher_is_back: false,
            stopped: None,
            intended: false,
            undisturbed: false,
            touching: TOUCHING,
            slot: 0,
            seen: Observation::default(),
            tactile: Vec::new(),
            force: None,
            reference,
        }
    }
}
