//! Scenes in the paper's regime: [`PinnedScene`].

use serde::Deserialize;
use stickslip_formats::{TruthFacts, read_scene};

use super::replicate::{RATE, Replicate};
use super::scenes::PaperExperiment;
use crate::simulation::{
    PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationError, SimulationOptions,
};

/// The file of all scenes.
const SCENES: &str = include_str!("../../scenes/pinned.toml");

/// A scene in which two of the paper's columns have the paper's values: the errors of the nominal
/// simulation and of the Kalman filter, which do not depend on its particle filter. The contacts
/// tell the story of the experiment. No particle filter ran before the scene was chosen.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinnedScene {
    /// Its name.
    pub name: String,
    /// Group of scenes that it is counted in.
    #[serde(rename = "experiment")]
    pub group: PinnedGroup,
    /// Seed of the testbed.
    pub seed: u64,
    /// First row without the camera.
    pub dark: usize,
    /// True friction μ_s, μ_p, μ_f.
    pub friction: [f64; 3],
    /// scene.toml.
    pub scene: String,
}

/// Scenes of one of the paper's experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum PinnedGroup {
    /// Table II.
    A,
    /// Table III.
    B,
    /// Table IV, first row.
    #[serde(rename = "1")]
    First,
    /// Experiment 1, where friction decides: 10 to 25 % of it change the end by more than 10 mm.
    #[serde(rename = "1F")]
    FirstForks,
    /// Table IV, second row.
    #[serde(rename = "2")]
    Second,
    /// Experiment 2, where friction decides.
    #[serde(rename = "2F")]
    SecondForks,
    /// Table IV, third row.
    #[serde(rename = "3")]
    Third,
    /// Table IV, last row.
    #[serde(rename = "4")]
    Fourth,
}

#[derive(Deserialize)]
struct Scenes {
    scene: Vec<PinnedScene>,
}

impl PinnedScene {
    /// All scenes, experiment by experiment.
    ///
    /// # Panics
    /// If the embedded file is damaged.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let file: Scenes = toml::from_str(SCENES).expect("the embedded scenes are TOML");
        file.scene
    }

    /// The scene of this name.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn named(name: &str) -> Self {
        let mut scenes = Self::all().into_iter();
        scenes
            .find(|scene| scene.name == name)
            .unwrap_or_else(|| panic!("no pinned scene is named {name}"))
    }

    /// Simulates the scene, for filters of seed 0.
    ///
    /// # Errors
    /// The testbed refuses the rig.
    ///
    /// # Panics
    /// If the embedded scene is damaged.
    pub fn simulate(&self) -> Result<Replicate, SimulationError> {
        let setup = read_scene(&self.scene, &self.name).expect("the embedded scene is one");
        let [mu_s, mu_p, mu_f] = self.friction.map(Some);
        let known = TruthFacts {
            mu_s,
            mu_p,
            mu_f,
            occlude_from: Some(self.dark),
            ..TruthFacts::default()
        };
        let options = SimulationOptions {
            physics: Physics::Testbed,
            seeds: self.seed.into(),
            rate: RATE,
            repeats: REPEATS,
            pusher_memory: PUSHER_MEMORY,
        };
        let simulation = Simulation::run(&setup, &known, &options, &mut |_, _| ())?;
        Ok(Replicate {
            paper: self.group.paper(),
            seed: 0,
            occlusion: simulation.facts.occlusion(),
            experiment: simulation.into_experiment(setup),
        })
    }
}

impl PinnedGroup {
    /// All groups, in the paper's order.
    pub const ALL: [Self; 8] = [
        Self::A,
        Self::B,
        Self::First,
        Self::FirstForks,
        Self::Second,
        Self::SecondForks,
        Self::Third,
        Self::Fourth,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstForks => "1F",
            Self::SecondForks => "2F",
            group => group.paper().name(),
        }
    }

    /// The paper's experiment.
    #[must_use]
    pub fn paper(self) -> PaperExperiment {
        match self {
            Self::A => PaperExperiment::A,
            Self::B => PaperExperiment::B,
            Self::First | Self::FirstForks => PaperExperiment::First,
            Self::Second | Self::SecondForks => PaperExperiment::Second,
            Self::Third => PaperExperiment::Third,
            Self::Fourth => PaperExperiment::Fourth,
        }
    }

    /// Returns true if the object slides at its fixel; otherwise it stops there.
    #[must_use]
    pub fn slides(self) -> bool {
        match self {
            Self::B | Self::First | Self::Second | Self::FirstForks | Self::SecondForks => true,
            Self::A | Self::Third | Self::Fourth => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::RunSettings;
    use crate::variant::Variant;

    /// The nominal simulation has the paper's error in the scenes as they are here: the columns by
    /// which they were chosen.
    #[test]
    fn the_nominal_simulation_has_the_papers_error() {
        let settings = RunSettings {
            model: stickslip::FilterModel::Paper,
            particles: 1,
            tracking: stickslip::Tracking::Smoothed,
        };
        let scenes = PinnedScene::all();
        assert_eq!(scenes.len(), 106);
        for (group, paper_mm) in [
            (PinnedGroup::A, 4.81),
            (PinnedGroup::B, 4.0),
            (PinnedGroup::Second, 32.9),
        ] {
            let own = scenes.iter().filter(|scene| scene.group == group);
            for scene in own.take(3) {
                let experiment = scene.simulate().unwrap();
                let run = experiment.run(Variant::Nominal, settings).unwrap();
                let error = run.scores.wmse_mm.unwrap();
                assert!(
                    (error / paper_mm - 1.0).abs() < 0.2,
                    "{}: {error} mm, {paper_mm} in the paper",
                    scene.name
                );
            }
        }
    }
}
