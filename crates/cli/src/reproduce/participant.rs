//! Who takes part in the paper's evaluation: [`Participant`], a method with or without a camera
//! after the blackout begins.

use anyhow::Result;
use stickslip::{Observer, Occlusion, Run};
use stickslip_formats::Experiment;
use stickslip_report::Colour;

use crate::contest::{Rival, Rules};

/// What the camera does after the blackout begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// It is dark.
    Dark,
    /// It goes on.
    Open,
}

/// A method and what it sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Participant {
    /// The method.
    pub rival: Rival,
    /// What it sees.
    pub sight: Sight,
}

/// The nominal simulation, which sees the first frame only.
pub const NOMINAL: Participant = Participant {
    rival: Rival::Nominal,
    sight: Sight::Dark,
};
/// The Kalman filter.
pub const KALMAN: Participant = Participant {
    rival: Rival::Kalman,
    sight: Sight::Dark,
};
/// The Kalman filter without a blackout.
pub const KALMAN_OPEN: Participant = Participant {
    rival: Rival::Kalman,
    sight: Sight::Open,
};
/// The particle filter without tactile data.
pub const BLIND: Participant = Participant {
    rival: Rival::ParticleNoTactile,
    sight: Sight::Dark,
};
/// The particle filter without tactile data and without a blackout.
pub const BLIND_OPEN: Participant = Participant {
    rival: Rival::ParticleNoTactile,
    sight: Sight::Open,
};
/// The particle filter with tactile data.
pub const TACTILE: Participant = Participant {
    rival: Rival::Particle,
    sight: Sight::Dark,
};
/// The particle filter with tactile data and without a blackout.
pub const TACTILE_OPEN: Participant = Participant {
    rival: Rival::Particle,
    sight: Sight::Open,
};

impl Participant {
    /// Name in tables and figures.
    pub fn name(self) -> &'static str {
        match (self.rival, self.sight) {
            (Rival::Nominal, _) => "nominal simulation",
            (Rival::Kalman, Sight::Dark) => "Kalman filter",
            (Rival::Kalman, Sight::Open) => "Kalman filter, camera on",
            (Rival::ParticleNoTactile, Sight::Dark) => "particle filter, no tactile",
            (Rival::ParticleNoTactile, Sight::Open) => "particle filter, no tactile, camera on",
            (_, Sight::Dark) => "particle filter, tactile",
            (_, Sight::Open) => "particle filter, tactile, camera on",
        }
    }

    /// Colour in figures: those of the paper, as colour-blind people can tell them apart.
    pub fn colour(self) -> Colour {
        match self.rival {
            Rival::Nominal => Colour::ORANGE,
            Rival::Kalman => Colour::VERMILLION,
            Rival::ParticleNoTactile => Colour::GREEN,
            _ => Colour::BLUE,
        }
    }

    /// Name in JSON.
    pub fn key(self) -> &'static str {
        match (self.rival, self.sight) {
            (Rival::Nominal, _) => "nominal",
            (Rival::Kalman, Sight::Dark) => "kalman",
            (Rival::Kalman, Sight::Open) => "kalman_camera_on",
            (Rival::ParticleNoTactile, Sight::Dark) => "particle_no_tactile",
            (Rival::ParticleNoTactile, Sight::Open) => "particle_no_tactile_camera_on",
            (_, Sight::Dark) => "particle_tactile",
            (_, Sight::Open) => "particle_tactile_camera_on",
        }
    }

    /// Runs it on an experiment in which `blackout` hides the object.
    pub fn run(
        self,
        experiment: &Experiment,
        blackout: Occlusion,
        rules: &Rules,
        seed: u64,
        watch: Option<&dyn Observer>,
    ) -> Result<Run> {
        let hidden = match self.sight {
            Sight::Dark => blackout,
            Sight::Open => Occlusion::None,
        };
        self.rival.run(experiment, hidden, rules, seed, watch)
    }
}
