//! What steps have in common: [`Stage`] of all, [`Moment`] of one for all its particles.

use crate::plane::Frame;
use crate::scene::Scene;
use crate::step::{PusherMotion, StepInput};

/// A scene, with what of it no step changes.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub scene: Scene,
    /// Where the feet stand, see [`Scene::stance`].
    pub stance: [[f64; 2]; 3],
    /// Where the fixels stand.
    pub fixels: Vec<Frame>,
}

impl Stage {
    pub fn new(scene: Scene) -> Self {
        Self { stance: scene.stance(), fixels: scene.fixels.iter().map(|fixel| Frame::new(fixel.pose)).collect(), scene }
    }
}

/// What drives one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<'a> {
    pub input: &'a StepInput,
    /// The pusher's motion and where it stands.
    pub pusher: Option<(&'a PusherMotion, Frame)>,
}

impl<'a> Moment<'a> {
    pub fn new(input: &'a StepInput) -> Self {
        Self { input, pusher: input.pusher.as_ref().map(|motion| (motion, Frame::new(motion.pose))) }
    }
}
