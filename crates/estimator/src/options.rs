//! How a run is made: [`RunOptions`].

use crate::filter_model::FilterModel;
use crate::moves::Moves;
use crate::occlusion::Occlusion;
use crate::pusher::track::Tracking;

/// How a log is turned into estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// The particle filter over contact dynamics.
    #[default]
    Particle,
    /// A constant-velocity Kalman filter that knows nothing of contact.
    Kalman,
    /// The same, at rest from the first tactile contact in the dark on.
    KalmanStops,
    /// The same, which in the dark moves with the pusher as if glued to it.
    WithPusher,
    /// An extended Kalman filter over contact dynamics, which does not feel touch.
    ExtendedKalman,
    /// The nominal simulation, which never looks at the camera after the first pose.
    Nominal,
}

/// Whether tactile data is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TactileUse {
    /// Tactile readings weigh the particles.
    #[default]
    Used,
    /// They are ignored.
    Ignored,
}

/// Options of a run; the defaults are those of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Method.
    pub method: Method,
    /// Rules of the particle filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Use of tactile data.
    pub tactile: TactileUse,
    /// How the pusher is tracked.
    pub tracking: Tracking,
    /// Forced number of substeps per row; `None`: by the length of the step.
    pub substeps: Option<u32>,
    /// What is hidden from the method.
    pub occlusion: Occlusion,
    /// What brings particles to where weighing alone would leave few (contact mode).
    pub moves: Moves,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            method: Method::Particle,
            model: FilterModel::default(),
            particles: 500,
            seed: 0,
            tactile: TactileUse::Used,
            tracking: Tracking::Smoothed,
            substeps: None,
            occlusion: Occlusion::None,
            moves: Moves::default(),
        }
    }
}
