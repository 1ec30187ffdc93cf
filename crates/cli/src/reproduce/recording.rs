//! One of the paper's experiments as it was recorded once: [`Recording`].

use anyhow::Result;
use stickslip::Occlusion;
use stickslip_formats::{Experiment, read_scene, read_truth_json};

use crate::args::Physics;
use crate::paper::{PaperExperiment, PaperScene};
use crate::simulation::{Options, Simulation};

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
        let PaperScene { name, scene, truth, .. } = paper.scene();
        let setup = read_scene(scene, &format!("{name}/scene.toml"))?;
        let known = read_truth_json(truth, &format!("{name}/truth.json"))?;
        let Simulation { log, truth, facts, .. } =
            Simulation::run(&setup, name, &known, &Options { physics: Physics::Testbed, seed, rate: RATE })?;
        let blackout = facts.occlude_from.map_or(Occlusion::None, |from| Occlusion::Rows { from, to: None });
        Ok(Self { paper, seed, experiment: Experiment::new(setup, log, Some(truth), facts)?, blackout })
    }
}
