//! Random scenes in closed loop: [`ClosedLoop`] makes a scene, records a push in it, and lets the
//! particle filter follow that with noise, warm starts and resampling, while every step is judged.
//!
//! A scene is a pure function of (seed, index, frames, particles); so is everything that is
//! counted. Only the times are not.

mod block_timer;
mod existence;
mod layout;
mod loop_tally;
mod mass_properties;
mod placement;
mod pusher_path;
mod random_scene;
mod recording;
mod scene_kind;
mod shapes;
mod step_judge;

pub use existence::Existence;
pub use loop_tally::{LoopTally, StepAddress};
pub use random_scene::PusherPoses;
pub use scene_kind::SceneKind;
pub use step_judge::{NotedStep, NotedSteps};

use std::ops::Range;

use rayon::prelude::*;
use stickslip::{Log, RunError, Setup, run_observed};
use stickslip_dynamics::Dynamics;

use crate::harvest::MOST_PARTICLES;
use random_scene::RandomScene;
use recording::record;
use step_judge::StepJudge;

/// An endless fixed sequence of random scenes, and how each is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClosedLoop {
    /// Different seeds give unrelated scenes.
    pub seed: u64,
    /// Frames of each log; those in which the object flies off are shorter.
    pub frames: usize,
    /// Particles of the filter, at most [`MOST_PARTICLES`].
    pub particles: usize,
}

/// One scene's run.
#[derive(Clone, Debug)]
pub struct SceneRun {
    /// Index of the scene.
    pub index: u64,
    /// Kind of its layout.
    pub kind: SceneKind,
    /// Poses of the pusher in its log.
    pub pusher_poses: PusherPoses,
    /// True if the filter assumes a pusher that never yields.
    pub rigid: bool,
    /// Outcomes of its steps.
    pub tally: LoopTally,
    /// Noteworthy steps.
    pub noted: NotedSteps,
}

impl ClosedLoop {
    /// Runs scene `index`, and notes the first `notes` steps of each outcome
    /// but solved.
    ///
    /// # Errors
    /// The filter refuses the scene.
    ///
    /// # Panics
    /// With fewer than two frames, or more than [`MOST_PARTICLES`].
    pub fn run(&self, index: u64, notes: usize) -> Result<SceneRun, RunError> {
        assert!(self.frames >= 2, "{} frames, at least 2", self.frames);
        assert!(
            self.particles <= MOST_PARTICLES,
            "{} particles, at most {MOST_PARTICLES}",
            self.particles
        );
        let scene = RandomScene::draw(self.seed, index, self.frames, self.particles);
        let log = record(&scene);
        let dynamics = Dynamics::new(scene.setup.scene.clone());
        let judge = StepJudge::new(&dynamics, index, notes);
        run_observed(&scene.setup, &log, &scene.options, &judge, &mut |_| ())?;
        let state = judge.into_state();
        Ok(SceneRun {
            index,
            kind: scene.kind,
            pusher_poses: scene.pusher_poses,
            rigid: scene.setup.scene.pusher.stall_force.is_none(),
            tally: state.tally,
            noted: state.noted,
        })
    }

    /// Setup of the filter in scene `index`, and the log of its push.
    #[must_use]
    pub fn setup_and_log(&self, index: u64) -> (Setup, Log) {
        let scene = RandomScene::draw(self.seed, index, self.frames, self.particles);
        let log = record(&scene);
        (scene.setup, log)
    }

    /// Scene `index` in words: friction, drive, noise and how the filter is run.
    #[must_use]
    pub fn describe(&self, index: u64) -> String {
        RandomScene::draw(self.seed, index, self.frames, self.particles).to_string()
    }

    /// Runs the scenes of `range`, one to a thread; `progress` is shown each as it ends, in no
    /// fixed order.
    ///
    /// # Errors
    /// The filter refuses a scene.
    pub fn run_all(
        &self,
        range: Range<u64>,
        progress: &(dyn Fn(&SceneRun) + Sync),
    ) -> Result<Vec<SceneRun>, RunError> {
        range
            .into_par_iter()
            .map(|index| self.run(index, 0).inspect(|run| progress(run)))
            .collect()
    }
}
