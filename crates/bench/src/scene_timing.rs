//! A scene timed frame by frame from start to end: [`time_scenes`].

use std::io;
use std::ops::Range;

use stickslip::quantile;
use stickslip_dynamics::{Dynamics, StepInput};

use crate::batch::Batch;
use crate::results::Results;
use crate::step_statistics::StepStatistics;

/// Blocks of particles in a measured batch.
const BLOCKS: u32 = 4;

/// A scene with its inputs.
#[derive(Clone, Debug)]
pub struct TimedScene {
    /// Its name in the results.
    pub name: String,
    /// Scene and instructions.
    pub dynamics: Dynamics,
    /// One step per frame.
    pub inputs: Vec<StepInput>,
}

/// Times and step statistics of a scene, frame by frame.
#[derive(Clone, Debug)]
pub struct SceneTiming {
    name: String,
    /// Per frame: time per particle in each round (ns).
    times: Vec<Vec<f64>>,
    /// Per frame.
    statistics: Vec<StepStatistics>,
}

/// A scene's timing over some frames.
#[derive(Clone, Debug)]
pub struct TimingSummary {
    /// Median over the frames of the median over the rounds, time per particle-step (ns).
    pub nanoseconds: f64,
    /// Statistics of the frames' steps.
    pub statistics: StepStatistics,
}

/// Runs every scene from start to end `rounds` times with 512 scattered particles on one thread. A
/// round runs all scenes in turn; a first round is not counted.
#[must_use]
pub fn time_scenes(scenes: &[TimedScene], rounds: usize) -> Vec<SceneTiming> {
    let mut timings: Vec<SceneTiming> = scenes.iter().map(SceneTiming::new).collect();
    for round in 0..=rounds {
        for (scene, timing) in scenes.iter().zip(&mut timings) {
            timing.run(scene, round > 0);
        }
    }
    timings
}

impl SceneTiming {
    fn new(scene: &TimedScene) -> Self {
        let frames = scene.inputs.len();
        Self {
            name: scene.name.clone(),
            times: vec![Vec::new(); frames],
            statistics: vec![StepStatistics::default(); frames],
        }
    }

    fn run(&mut self, scene: &TimedScene, counted: bool) {
        let mut batch = Batch::scattered(&scene.dynamics, BLOCKS);
        for (frame, input) in scene.inputs.iter().enumerate() {
            let time = batch.step(&scene.dynamics, input);
            if counted {
                self.times[frame].push(time);
                batch
                    .reports()
                    .for_each(|report| self.statistics[frame].count(report));
            }
        }
    }

    /// Time and statistics of some frames.
    #[must_use]
    pub fn over(&self, frames: Range<usize>) -> TimingSummary {
        let times: Vec<f64> = self.times[frames.clone()]
            .iter()
            .map(|rounds| median(rounds))
            .collect();
        let mut statistics = StepStatistics::default();
        self.statistics[frames]
            .iter()
            .for_each(|of_frame| statistics.add(of_frame));
        TimingSummary {
            nanoseconds: median(&times),
            statistics,
        }
    }

    /// Writes time, iterations, residual and routes of some frames.
    ///
    /// # Errors
    /// The results cannot be written.
    pub fn write(
        &self,
        phase: &str,
        frames: Range<usize>,
        results: &mut Results,
    ) -> io::Result<()> {
        let TimingSummary {
            nanoseconds,
            statistics,
        } = self.over(frames);
        let name = format!("{} / {phase}", self.name);
        results.write(&name, nanoseconds, "ns/particle-step")?;
        results.write(
            &format!("{name} / iterations"),
            statistics.mean_iterations(),
            "1",
        )?;
        results.write(
            &format!("{name} / worst residual"),
            statistics.worst_residual(),
            "m/s",
        )?;
        results.write(
            &format!("{name} / unsolved"),
            statistics.unsolved() as f64 / statistics.steps() as f64,
            "1",
        )?;
        for (route, share) in statistics.route_shares() {
            results.write(&format!("{name} / by {route}"), share, "1")?;
        }
        Ok(())
    }
}

/// NaN of nothing.
fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5).unwrap_or(f64::NAN)
}
