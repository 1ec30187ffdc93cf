//! Options of a contact filter: [`FilterOptions`].

use stickslip_filter::{Resampling, Settings};

use crate::filter_model::FilterModel;
use crate::particle::observer::Observer;
use crate::setup::Setup;

/// Options of a contact filter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterOptions<'o> {
    /// Configuration of the filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Longest time before the latest row at which late poses may show the object (s).
    pub late: f64,
    /// True if camera poses may move particles (robust model).
    pub camera_moves: bool,
    /// Observer of every time step.
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
