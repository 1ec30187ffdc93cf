//! Settings of a particle filter: [`Settings`].

use crate::resample::Resampling;

/// Settings of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The number N of particles, at least 1.
    pub particles: usize,
    /// The seed of all random numbers.
    pub seed: u64,
    /// A step begins with resampling if the effective sample size is below this share of N; in
    /// [0, 1].
    pub resample_below: f64,
    /// The resampling scheme.
    pub resampling: Resampling,
}

impl Default for Settings {
    /// 500 particles, seed 0, systematic resampling below N/2.
    fn default() -> Self {
        Settings {
            particles: 500,
            seed: 0,
            resample_below: 0.5,
            resampling: Resampling::Systematic,
        }
    }
}

impl Settings {
    /// Refuses settings out of range.
    ///
    /// # Errors
    /// If the number of particles or the threshold is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let (particles, share) = (self.particles, self.resample_below);
        if particles == 0 || u32::try_from(particles).is_err() {
            return Err(SettingsError::Particles { particles });
        }
        if !(0.0..=1.0).contains(&share) {
            return Err(SettingsError::ResampleBelow { share });
        }
        Ok(())
    }
}

/// Reason why settings were refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The number of particles is 0 or does not fit u32.
    #[error("`particles` is {particles}; it must be at least 1 and below 2^32; try 500")]
    Particles {
        /// The number found.
        particles: usize,
    },
    /// The threshold is not a share.
    #[error("`resample_below` is {share}; it is a share of the particles in [0, 1]; try 0.5")]
    ResampleBelow {
        /// The number found.
        share: f64,
    },
}
