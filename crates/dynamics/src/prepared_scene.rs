//! What steps have in common: [`Stage`] of all, [`Moment`] of one for all its particles.

use crate::geometry::transform::Transform;
use crate::input::{PusherMotion, StepInput};
use crate::scene::Scene;

/// A scene, with what of it no step changes.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub scene: Scene,
    /// The object's radius of gyration ρ (m).
    pub rho: f64,
    /// Reciprocals of ρ, of the object's mass and of its moment of inertia: the divider is the
    /// slowest part of a vector unit.
    pub per_rho: f64,
    pub per_mass: f64,
    pub per_inertia: f64,
    /// Where the feet stand, see [`Scene::stance`].
    pub stance: [[f64; 2]; 3],
    /// Where the fixels stand.
    pub fixels: Vec<Transform>,
}

impl Stage {
    pub fn new(scene: Scene) -> Self {
        let (rho, per_mass, per_inertia) = (
            scene.object.gyration_radius(),
            1.0 / scene.object.mass,
            1.0 / scene.object.inertia,
        );
        let fixels = scene
            .fixels
            .iter()
            .map(|fixel| Transform::from(fixel.pose))
            .collect();
        Self {
            rho,
            per_rho: 1.0 / rho,
            per_mass,
            per_inertia,
            stance: scene.stance(),
            fixels,
            scene,
        }
    }
}

/// What drives one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<'a> {
    pub input: &'a StepInput,
    /// 1/h (1/s).
    pub rate: f64,
    /// The pusher's motion and where it stands.
    pub pusher: Option<(&'a PusherMotion, Transform)>,
}

impl<'a> Moment<'a> {
    pub fn new(input: &'a StepInput) -> Self {
        Self {
            input,
            rate: 1.0 / input.h,
            pusher: input
                .pusher
                .as_ref()
                .map(|motion| (motion, Transform::from(motion.pose))),
        }
    }
}
