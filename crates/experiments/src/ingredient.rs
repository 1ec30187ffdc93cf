//! Parts of the robust model, to be left out one by one: [`Ingredient`].

use stickslip::dynamics::Friction;
use stickslip::{RunOptions, Setup, TactileUse};

/// One part of the robust model: an uncertainty that it allows for or a step that it takes, see
/// docs/decisions/007.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ingredient {
    /// Priors of the friction parameters.
    FrictionPriors,
    /// A centre of friction that is not the centre of mass, and feet that are turned.
    Support,
    /// Four fifths of the random force: without any, particles would have one future.
    Force,
    /// An offset between the camera's frame and the pusher's.
    PusherOffset,
    /// The pusher as a sensor.
    PusherAsSensor,
    /// Errors of the fixels' positions.
    FixelPositions,
    /// Rigs that differ in how rough they are.
    Roughness,
    /// Rigs that are measured much better than others.
    WellMeasured,
    /// A camera of unknown noise.
    CameraNoise,
    /// A camera of unknown latency.
    Latency,
    /// Touch.
    Touch,
    /// Camera poses that move particles, (45).
    CameraMoves,
}

impl Ingredient {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::FrictionPriors,
        Self::Support,
        Self::Force,
        Self::PusherOffset,
        Self::PusherAsSensor,
        Self::FixelPositions,
        Self::Roughness,
        Self::WellMeasured,
        Self::CameraNoise,
        Self::Latency,
        Self::Touch,
        Self::CameraMoves,
    ];

    /// Name of a run without it.
    #[must_use]
    pub fn left_out(self) -> &'static str {
        match self {
            Self::FrictionPriors => "nominal friction",
            Self::Support => "nominal feet",
            Self::Force => "a fifth of the force",
            Self::PusherOffset => "pusher where logged",
            Self::PusherAsSensor => "pusher no sensor",
            Self::FixelPositions => "nominal fixel positions",
            Self::Roughness => "all rigs alike",
            Self::WellMeasured => "no rig measured better",
            Self::CameraNoise => "nominal camera noise",
            Self::Latency => "nominal latency",
            Self::Touch => "no touch",
            Self::CameraMoves => "weighing alone, (45)",
        }
    }

    /// Takes it out of a run.
    pub fn remove_from(self, setup: &mut Setup, options: &mut RunOptions) {
        let unknown = &mut setup.uncertainty;
        match self {
            Self::FrictionPriors => unknown.friction = Friction::default(),
            Self::Support => *unknown = unknown.with_known_feet(),
            Self::Force => unknown.force_std *= 0.2,
            Self::PusherOffset => unknown.pusher_offset = 0.0,
            Self::PusherAsSensor => unknown.pusher_lag = FAR,
            Self::FixelPositions => unknown.fixel_position = 0.0,
            Self::Roughness => unknown.roughness = 0.0,
            Self::WellMeasured => unknown.well_measured = 1.0,
            Self::CameraNoise => unknown.camera_noise = 0.0,
            Self::Latency => unknown.latency = 0.0,
            Self::Touch => options.tactile = TactileUse::Ignored,
            Self::CameraMoves => options.camera_moves = false,
        }
    }
}

/// A lag that contradicts nothing (m).
const FAR: f64 = 1e3;
