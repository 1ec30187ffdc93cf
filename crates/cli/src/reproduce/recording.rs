//! One of the paper's experiments as it was recorded once: [`Recording`].

use anyhow::Result;
use stickslip::{Camera, Occlusion, Setup};
use stickslip_formats::{Experiment, read_scene, read_truth_json};

use super::noise::Noise;
use crate::args::Physics;
use crate::paper::{PaperExperiment, PaperScene};
use crate::simulation::{Options, REPEATS, Simulation};

/// Frames per second (Hz), as in the paper.
const RATE: f64 = 30.0;

/// One recording of an experiment.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Which experiment.
    pub paper: PaperExperiment,
    /// Seed of rig, sensors and filters.
    pub seed: u64,
    /// What is known before, what was measured, and what is true.
    pub experiment: Experiment,
    /// When the camera is dark.
    pub blackout: Occlusion,
}

impl Recording {
    /// Simulates an experiment on the testbed, its camera as the scene says.
    pub fn simulate(paper: PaperExperiment, seed: u64) -> Result<Self> {
        Self::simulate_with(paper, seed, |setup| (setup, REPEATS))
    }

    /// The same rig, its poses simulated with the noise of tracked ones, missing wherever they are;
    /// the methods are told the same.
    pub fn with_noise(&self, noise: &Noise) -> Result<Self> {
        let camera = Some(noise.camera());
        let mut recording = Self::simulate_with(self.paper, self.seed, |setup| {
            (Setup { camera, ..setup }, 0.0)
        })?;
        let log = &mut recording.experiment.log;
        for (mine, theirs) in [
            (&mut log.object, &self.experiment.log.object),
            (&mut log.pusher, &self.experiment.log.pusher),
        ] {
            mine.iter_mut()
                .zip(theirs)
                .for_each(|(mine, theirs)| *mine = mine.filter(|_| theirs.is_some()));
        }
        Ok(recording.told(noise.told()))
    }

    /// The same poses, and the methods are told of this camera.
    pub fn told(self, camera: Camera) -> Self {
        let setup = Setup {
            camera: Some(camera),
            ..self.experiment.setup
        };
        Self {
            experiment: Experiment {
                setup,
                ..self.experiment
            },
            ..self
        }
    }

    /// `of` gives the setup, and the share of frames that are repeated.
    fn simulate_with(
        paper: PaperExperiment,
        seed: u64,
        of: impl Fn(Setup) -> (Setup, f64),
    ) -> Result<Self> {
        let PaperScene {
            name, scene, truth, ..
        } = paper.scene();
        let (setup, repeats) = of(read_scene(scene, &format!("{name}/scene.toml"))?);
        let known = read_truth_json(truth, &format!("{name}/truth.json"))?;
        let options = Options {
            physics: Physics::Testbed,
            seed,
            rate: RATE,
            repeats,
        };
        let Simulation {
            log, truth, facts, ..
        } = Simulation::run(&setup, name, &known, &options)?;
        let blackout = facts
            .occlude_from
            .map_or(Occlusion::None, |from| Occlusion::Rows { from, to: None });
        Ok(Self {
            paper,
            seed,
            experiment: Experiment::new(setup, log, Some(truth), facts)?,
            blackout,
        })
    }
}
