//! Options of a run: [`RunOptions`].

use crate::filter_model::FilterModel;
use crate::occlusion::Occlusion;
use crate::pusher::track::Tracking;

/// Method that turns a log into estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// The particle filter over contact dynamics.
    #[default]
    Particle,
    /// A constant-velocity Kalman filter, without contacts.
    Kalman,
    /// The Kalman filter; while the camera is off, the object rests from the first tactile contact
    /// on.
    KalmanStops,
    /// The Kalman filter; while the camera is off, the object moves as if glued to the pusher.
    WithPusher,
    /// An extended Kalman filter over contact dynamics, which does not use touch.
    ExtendedKalman,
    /// The nominal simulation, which uses no camera pose after the first.
    Nominal,
}

/// Use of tactile data.
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
    /// Configuration of the particle filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Use of tactile data.
    pub tactile: TactileUse,
    /// Tracking of the pusher.
    pub tracking: Tracking,
    /// Forced number of substeps per row; `None`: by the length of the step.
    pub substeps: Option<u32>,
    /// Rows whose object poses are hidden from the method.
    pub occlusion: Occlusion,
    /// True if camera poses move particles as well as weigh them (robust model; docs/model.md
    /// (45)).
    pub camera_moves: bool,
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
            camera_moves: true,
        }
    }
}
