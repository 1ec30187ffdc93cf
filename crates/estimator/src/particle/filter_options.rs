//! What a contact filter is made with: [`FilterOptions`].

use stickslip_filter::{Resampling, Settings};

use crate::filter_model::FilterModel;
use crate::moves::Moves;
use crate::particle::observer::Observer;
use crate::setup::Setup;

/// What a contact filter is made with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterOptions<'o> {
    /// Rules of the filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How far before the latest row late poses may show the object (s).
    pub late: f64,
    /// What brings particles to where weighing would leave few (contact mode).
    pub moves: Moves,
    /// Share of a camera pose that moves particles at least, where it may move them (contact mode).
    pub least_moved: f64,
    /// Is shown every time step.
    pub observer: Option<&'o dyn Observer>,
}

impl FilterOptions<'_> {
    /// Settings of the particle filter.
    pub fn settings(&self, setup: &Setup) -> Settings {
        Settings {
            particles: self.particles,
            seed: self.seed,
            resample_below: setup.filter.resample_below,
            resampling: Resampling::Systematic,
        }
    }
}
