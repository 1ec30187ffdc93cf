//! One of the paper's experiments with one seed: [`Replicate`].

use stickslip::{Camera, FilterModel, Occlusion, RunError, Setup, Tracking};
use stickslip_formats::{Experiment, read_scene, read_truth_json};

use super::noise::Noise;
use super::scenes::{PaperExperiment, PaperScene};
use crate::run::{RunConditions, ScoredRun};
use crate::simulation::{
    PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationError, SimulationOptions,
};
use crate::variant::Variant;

/// Frames per second (Hz), as in the paper.
pub(super) const RATE: f64 = 30.0;

/// Settings that all runs of an evaluation have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunSettings {
    /// Rules of the particle filter; the paper's are [`FilterModel::Paper`].
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Tracking of the thumb.
    pub tracking: Tracking,
}

impl RunSettings {
    /// Conditions of a run with these rows hidden and this seed.
    pub(super) fn conditions(self, occlusion: Occlusion, seed: u64) -> RunConditions {
        RunConditions {
            model: self.model,
            particles: self.particles,
            tracking: self.tracking,
            occlusion,
            seed,
        }
    }
}

/// One of the paper's experiments with one seed.
#[derive(Clone, Debug)]
pub struct Replicate {
    /// The experiment.
    pub paper: PaperExperiment,
    /// Seed of the filters; in the paper's scenes that of rig and sensors, too.
    pub seed: u64,
    /// Setup, log and truth of the experiment.
    pub experiment: Experiment,
    /// Occlusion of the camera.
    pub occlusion: Occlusion,
}

impl Replicate {
    /// Simulates an experiment on the testbed, its camera as the scene says.
    ///
    /// # Errors
    /// The testbed refuses the seed's rig.
    pub fn simulate(paper: PaperExperiment, seed: u64) -> Result<Self, SimulationError> {
        Self::simulate_with(paper, seed, [REPEATS, PUSHER_MEMORY], |_| ())
    }

    /// Simulates the same rig with poses at the noise of tracked ones, missing where this
    /// replicate's are; the methods assume the same camera.
    ///
    /// # Errors
    /// Those of [`Replicate::simulate`].
    pub fn with_noise(&self, noise: &Noise) -> Result<Self, SimulationError> {
        let camera = Some(noise.camera());
        let mut replicate = Self::simulate_with(self.paper, self.seed, [0.0; 2], |setup| {
            setup.camera = camera
        })?;
        let (log, seen) = (&mut replicate.experiment.log, &self.experiment.log);
        for (poses, seen) in [
            (&mut log.object, &seen.object),
            (&mut log.pusher, &seen.pusher),
        ] {
            for (pose, seen) in poses.iter_mut().zip(seen) {
                *pose = pose.filter(|_| seen.is_some());
            }
        }
        Ok(replicate.given(noise.given_camera()))
    }

    /// Keeps the poses, and makes the methods assume this camera.
    #[must_use]
    pub fn given(mut self, camera: Camera) -> Self {
        self.experiment.setup.camera = Some(camera);
        self
    }

    /// Runs a variant.
    ///
    /// # Errors
    /// Those of [`stickslip::run`].
    pub fn run(&self, variant: Variant, settings: RunSettings) -> Result<ScoredRun, RunError> {
        ScoredRun::new(variant, &self.experiment, &self.conditions(settings), None)
    }

    /// Conditions of every variant: the replicate's own occlusion and seed.
    #[must_use]
    pub fn conditions(&self, settings: RunSettings) -> RunConditions {
        settings.conditions(self.occlusion, self.seed)
    }

    /// `repeats`: share of frames that are repeated, `pusher_memory`: how long the pusher's error
    /// lasts (s); `adjust` may change the scene.
    fn simulate_with(
        paper: PaperExperiment,
        seed: u64,
        [repeats, pusher_memory]: [f64; 2],
        adjust: impl FnOnce(&mut Setup),
    ) -> Result<Self, SimulationError> {
        let PaperScene {
            name, scene, truth, ..
        } = paper.scene();
        let mut setup = read_scene(scene, name).expect("the embedded scene is one");
        let known = read_truth_json(truth, name).expect("the embedded truth is one");
        adjust(&mut setup);
        let options = SimulationOptions {
            physics: Physics::Testbed,
            seeds: seed.into(),
            rate: RATE,
            repeats,
            pusher_memory,
        };
        let simulation = Simulation::run(&setup, &known, &options, &mut |_, _| ())?;
        Ok(Self {
            paper,
            seed,
            occlusion: simulation.facts.occlusion(),
            experiment: simulation.into_experiment(setup),
        })
    }
}
