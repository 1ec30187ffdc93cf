//! Parts of the robust model, to be left out one by one: [`Ingredient`].

use stickslip::dynamics::Friction;
use stickslip::{RunOptions, Setup, TactileUse};

/// One part of the robust model: an uncertainty that it allows for or a step that it takes, see
/// docs/decisions/007.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ingredient {
    /// Priors of the friction parameters, and their drift.
    FrictionPriors,
    /// A centre of friction that is not the centre of mass, and feet that are turned.
    Support,
    /// Friction that differs from place to place.
    Variation,
    /// Four fifths of the random force: without any, particles would have one future.
    Force,
    /// An offset between the camera's frame and the pusher's.
    PusherOffset,
    /// The pusher as a sensor.
    PusherAsSensor,
    /// Errors of the fixels' positions.
    FixelPositions,
    /// An error of the object's outline.
    Outline,
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
    /// Re-simulation of steps, (42).
    SecondTries,
    /// Latency exchanged for offset under a steady push, (43).
    SteadyPush,
    /// Redrawing of the pose of an object that waits, (44).
    Waiting,
    /// Camera poses that move particles, (45).
    CameraMoves,
}

impl Ingredient {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::FrictionPriors,
        Self::Support,
        Self::Variation,
        Self::Force,
        Self::PusherOffset,
        Self::PusherAsSensor,
        Self::FixelPositions,
        Self::Outline,
        Self::Roughness,
        Self::WellMeasured,
        Self::CameraNoise,
        Self::Latency,
        Self::Touch,
        Self::SecondTries,
        Self::SteadyPush,
        Self::Waiting,
        Self::CameraMoves,
    ];

    /// Name of a run without it.
    #[must_use]
    pub fn left_out(self) -> &'static str {
        match self {
            Self::FrictionPriors => "nominal friction, no drift",
            Self::Support => "nominal feet",
            Self::Variation => "no variation from place to place",
            Self::Force => "a fifth of the force",
            Self::PusherOffset => "pusher where logged",
            Self::PusherAsSensor => "pusher no sensor",
            Self::FixelPositions => "nominal fixel positions",
            Self::Outline => "nominal outline",
            Self::Roughness => "all rigs alike",
            Self::WellMeasured => "no rig measured better",
            Self::CameraNoise => "nominal camera noise",
            Self::Latency => "nominal latency",
            Self::Touch => "no touch",
            Self::SecondTries => "no re-simulation, (42)",
            Self::SteadyPush => "no exchange of latency, (43)",
            Self::Waiting => "object at rest not redrawn, (44)",
            Self::CameraMoves => "weighing alone, (45)",
        }
    }

    /// Takes it out of a run.
    pub fn remove_from(self, setup: &mut Setup, options: &mut RunOptions) {
        let (unknown, moves) = (&mut setup.uncertainty, &mut options.moves);
        match self {
            Self::FrictionPriors => {
                unknown.friction = Friction::default();
                unknown.drift = 0.0;
            }
            Self::Support => *unknown = unknown.with_known_feet(),
            Self::Variation => unknown.variation = 0.0,
            Self::Force => unknown.force_std *= 0.2,
            Self::PusherOffset => unknown.pusher_offset = 0.0,
            Self::PusherAsSensor => unknown.pusher_lag = FAR,
            Self::FixelPositions => unknown.fixel_position = 0.0,
            Self::Outline => unknown.outline = 0.0,
            Self::Roughness => unknown.roughness = 0.0,
            Self::WellMeasured => unknown.well_measured = 1.0,
            Self::CameraNoise => unknown.camera_noise = 0.0,
            Self::Latency => unknown.latency = 0.0,
            Self::Touch => options.tactile = TactileUse::Ignored,
            Self::SecondTries => moves.second_tries = false,
            Self::SteadyPush => moves.steady_push = false,
            Self::Waiting => moves.waiting = false,
            Self::CameraMoves => moves.camera = false,
        }
    }
}

/// A lag that contradicts nothing (m).
const FAR: f64 = 1e3;
