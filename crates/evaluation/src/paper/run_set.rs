//! All runs on one replicate: [`RunSet`].

use super::replicate::Replicate;
use super::scenes::PaperExperiment;
use crate::run::ScoredRun;
use crate::variant::Variant;

/// A replicate with all runs on it.
#[derive(Clone, Debug)]
pub struct RunSet {
    /// The replicate.
    pub replicate: Replicate,
    /// Its runs, one of each variant.
    pub runs: Vec<ScoredRun>,
}

impl PaperExperiment {
    /// The variants that are run on it: those of the paper's tables, and the same four on every
    /// experiment.
    #[must_use]
    pub fn variants(self) -> &'static [Variant] {
        use Variant::{
            Kalman, KalmanCameraOn, Nominal, Particle, ParticleCameraOn, ParticleNoTouch,
            ParticleNoTouchCameraOn,
        };
        match self {
            Self::A => &[
                Nominal,
                Kalman,
                ParticleNoTouch,
                Particle,
                KalmanCameraOn,
                ParticleNoTouchCameraOn,
                ParticleCameraOn,
            ],
            _ => &[Nominal, Kalman, ParticleNoTouch, Particle, ParticleCameraOn],
        }
    }
}

impl RunSet {
    /// The run of a variant; `None` where it was not run on this experiment.
    #[must_use]
    pub fn run(&self, variant: Variant) -> Option<&ScoredRun> {
        self.runs.iter().find(|run| run.variant == variant)
    }
}
