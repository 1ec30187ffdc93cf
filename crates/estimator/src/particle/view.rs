//! The particle set after a row, as an observer sees it: [`ParticleView`].

use stickslip_dynamics::{Friction, Pose};
use stickslip_filter::{LogWeights, ParticleSet};

use crate::particle::columns::Columns;

/// Particles with their weights; it can be looked at, not changed.
#[derive(Clone, Copy, Debug)]
pub struct ParticleView<'a> {
    particles: &'a ParticleSet,
    weights: &'a LogWeights,
}

impl<'a> ParticleView<'a> {
    pub(crate) fn new(particles: &'a ParticleSet, weights: &'a LogWeights) -> Self {
        Self { particles, weights }
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

    fn values<const K: usize>(&self, particle: usize, first: usize) -> [f64; K] {
        std::array::from_fn(|k| self.particles.value(particle, first + k))
    }
}
