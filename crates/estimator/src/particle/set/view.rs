//! The particle set after a row, as an observer sees it: [`ParticleView`].

use stickslip_dynamics::{Friction, Pose};
use stickslip_filter::{BLOCK, LogWeights, ParticleSet};

use crate::particle::model::ContactModel;
use crate::particle::sensor::observation::Observation;
use crate::particle::set::chunk::{LANES, is_set};
use crate::particle::set::columns::Columns;
use crate::particle::unknown::table::Name;

/// Particles with their weights, read-only.
#[derive(Clone, Copy, Debug)]
pub struct ParticleView<'a> {
    particles: &'a ParticleSet,
    weights: &'a LogWeights,
    model: &'a ContactModel<'a>,
    observation: &'a Observation,
    driven: bool,
}

impl<'a> ParticleView<'a> {
    /// The particles of `model`, which `observation` weighed. `driven` is true if the pusher moved
    /// in the step to it.
    pub(crate) fn new(
        (particles, weights): (&'a ParticleSet, &'a LogWeights),
        model: &'a ContactModel<'a>,
        observation: &'a Observation,
        driven: bool,
    ) -> Self {
        Self {
            particles,
            weights,
            model,
            observation,
            driven,
        }
    }

    /// Number of particles.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a particle set is never empty")]
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Weights of all particles, from 0 to 1; they sum to 1.
    #[must_use]
    pub fn weights(&self) -> &'a [f64] {
        self.weights.weights()
    }

    /// The object's pose according to one particle.
    ///
    /// # Panics
    /// If there is no such particle.
    #[must_use]
    pub fn pose(&self, particle: usize) -> Pose {
        let [x, y, theta] = self.values(particle, Columns::POSE);
        Pose::new(x, y, theta)
    }

    /// The friction according to one particle.
    ///
    /// # Panics
    /// If there is no such particle.
    #[must_use]
    pub fn friction(&self, particle: usize) -> Friction {
        let [mu_s, mu_p, mu_f, d_tri] = self.values(particle, Columns::FRICTION);
        Friction {
            mu_s,
            mu_p,
            mu_f,
            d_tri,
        }
    }

    /// The pose that the camera shows at this row according to one particle: where the object was
    /// one lag of the camera earlier.
    ///
    /// # Panics
    /// If there is no such particle.
    #[must_use]
    pub fn shown_pose(&self, particle: usize) -> Pose {
        let (block, i) = (self.particles.block(particle / BLOCK), particle % BLOCK);
        let camera = self.model.camera_likelihood();
        let shown = camera.shown(self.observation, &block, i / LANES);
        shown.map(|column| column.0[i % LANES])
    }

    /// ln of the factor between the measured force and the table's friction, according to one
    /// particle, in its prior's standard deviations; `None` without a force sensor.
    pub(crate) fn force_scale(&self, particle: usize) -> Option<f64> {
        let columns = self.model.columns();
        let column = columns.unknown(Name::ForceScale, 0);
        let known = columns.has(Name::ForceScale);
        known.then(|| self.particles.value(particle, column))
    }

    /// Returns true if the pusher moved in the step to the row.
    pub(crate) fn is_driven(&self) -> bool {
        self.driven
    }

    /// Returns true if the object touches the body of a sensor according to one particle.
    ///
    /// # Panics
    /// If there is no such particle.
    pub(crate) fn touches_sensor(&self, particle: usize, sensor: usize) -> bool {
        let block = self.particles.block(particle / BLOCK);
        let flag = self.model.columns().contact_of_sensor(sensor);
        is_set(&block, flag, particle % BLOCK)
    }

    fn values<const K: usize>(&self, particle: usize, first: usize) -> [f64; K] {
        std::array::from_fn(|k| self.particles.value(particle, first + k))
    }
}
