//! The nominal simulation of one log on many surfaces, side by side: [`NominalPredictor`].

use std::sync::Arc;

use stickslip_dynamics::{
    CompiledStep, Dynamics, Friction, Lanes, Offsets, Outcome, Particle, Particles, Pose, Scene,
    StepWork, Support,
};

use crate::error::RunError;
use crate::log::Log;
use crate::options::RunOptions;
use crate::prepared_log::PreparedLog;
use crate::pusher::schedule::Schedule;
use crate::setup::Setup;

/// Simulations side by side.
const LANES: usize = 8;

/// A log, ready to be predicted blind from its first object pose and its recorded pusher.
#[derive(Clone, Debug)]
pub struct NominalPredictor {
    dynamics: Dynamics,
    schedule: Arc<Schedule>,
    most_lag: f64,
    rows: usize,
    /// First row with an object pose.
    pub first: usize,
    /// The pose there.
    pub start: Pose,
}

/// Motion of the object from its first pose.
#[derive(Clone, Debug, PartialEq)]
pub struct NominalPrediction {
    /// Pose at every row, from the first one with an object pose.
    pub poses: Vec<Pose>,
    /// Steps without a certified solution.
    pub unsolved: u32,
}

/// Friction and support that may differ between predictions in one scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Friction parameters.
    pub friction: Friction,
    /// Image of the scene's feet.
    pub support: Support,
}

impl From<Friction> for Surface {
    /// On the scene's feet.
    fn from(friction: Friction) -> Self {
        Self {
            friction,
            support: Support::default(),
        }
    }
}

impl NominalPredictor {
    /// # Errors
    /// Those of [`run`](crate::run) with the nominal simulation.
    pub fn new(setup: &Setup, log: &Log) -> Result<Self, RunError> {
        let prepared = PreparedLog::new(setup, log, &RunOptions::default())?;
        Ok(Self {
            dynamics: Dynamics::new(setup.scene.clone()),
            most_lag: setup.most_pusher_lag(),
            rows: log.len(),
            first: prepared.first,
            start: prepared.start,
            schedule: Arc::new(prepared.schedule),
        })
    }

    /// Returns the predictor of this log in another scene.
    #[must_use]
    pub fn with_scene(&self, scene: Scene) -> Self {
        Self {
            dynamics: Dynamics::new(scene),
            schedule: Arc::clone(&self.schedule),
            ..*self
        }
    }

    /// Rows of the log.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Steps from row to row of the log.
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Predicts the log once with each of `surfaces`, as [`run`](crate::run) with the nominal
    /// simulation does with that of the scene, bit for bit. It runs on one thread.
    pub fn predict(&self, surfaces: &[Surface]) -> Vec<NominalPrediction> {
        let chunks = surfaces.chunks(LANES).map(|chunk| match chunk {
            [one] => Vec::from(self.predict_lanes(&[*one])),
            several => {
                // lanes that are left repeat the last one
                let last = several.len() - 1;
                let lanes = std::array::from_fn(|lane| several[lane.min(last)]);
                let mut predictions = Vec::from(self.predict_lanes::<LANES>(&lanes));
                predictions.truncate(several.len());
                predictions
            }
        });
        chunks.flatten().collect()
    }

    fn predict_lanes<const W: usize>(&self, surfaces: &[Surface; W]) -> [NominalPrediction; W]
    where
        StepWork<W>: CompiledStep<W>,
    {
        // offsets of none, but for the feet
        let pusher = [[Lanes::ZERO; 2]];
        let fixels = vec![[Lanes::ZERO; 2]; self.dynamics.scene().fixels.len()];
        let support = support_lanes(surfaces);
        let image = surfaces
            .iter()
            .any(|surface| surface.support != Support::default());
        let mut particles = [Particles::<W>::default()];
        let start = Particle {
            pose: self.start,
            ..Particle::default()
        };
        for (lane, surface) in surfaces.iter().enumerate() {
            particles[0].set(lane, &start, &surface.friction);
        }
        let mut predictions = std::array::from_fn(|_| NominalPrediction {
            poses: Vec::with_capacity(self.rows - self.first),
            unsolved: 0,
        });
        let write = |predictions: &mut [NominalPrediction; W], particles: &[Particles<W>; 1]| {
            for (lane, prediction) in predictions.iter_mut().enumerate() {
                let pose = particles[0].pose.map(|x| x.0[lane]);
                prediction.poses.push(pose);
            }
        };

        write(&mut predictions, &particles);
        let mut work = StepWork::<W>::default();
        for row in self.first..self.rows - 1 {
            particles[0].limit_pusher_lag(self.most_lag);
            for input in self.schedule.step(row) {
                if image {
                    let offsets = Offsets {
                        pusher: &pusher,
                        pusher_turn: &[],
                        fixels: &fixels,
                        supports: &support,
                    };
                    self.dynamics
                        .step_block_offset(input, offsets, &mut particles, &mut work);
                } else {
                    self.dynamics.step_block(input, &mut particles, &mut work);
                }
                for (prediction, report) in predictions.iter_mut().zip(&work.reports()[0]) {
                    prediction.unsolved += u32::from(report.outcome != Outcome::Solved);
                }
            }
            write(&mut predictions, &particles);
        }
        predictions
    }
}

/// Supports side by side.
fn support_lanes<const W: usize>(surfaces: &[Surface; W]) -> [Support<Lanes<W>>; 1] {
    let lanes = |of: &dyn Fn(&Support) -> f64| {
        Lanes(std::array::from_fn(|lane| of(&surfaces[lane].support)))
    };
    [Support {
        centre: [0, 1].map(|k| lanes(&|support| support.centre[k])),
        map: [0, 1].map(|k| [0, 1].map(|l| lanes(&|support| support.map[k][l]))),
    }]
}
