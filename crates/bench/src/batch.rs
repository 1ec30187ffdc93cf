//! Particles in blocks, as the particle filter holds them: [`Batch`].

use std::time::Instant;

use stickslip_dynamics::{Dynamics, Particle, Particles, Report, StepInput, StepWork};
use stickslip_filter::BLOCK;

use crate::scenes::scattered;

/// Particles that are stepped side by side.
pub const LANES: usize = 8;

/// One block of particles, the unit of work of a thread.
pub type FilterBlock = [Particles<LANES>; BLOCK / LANES];

/// A whole number of blocks, each with its working memory.
#[derive(Clone, Debug)]
pub struct Batch {
    blocks: Vec<(FilterBlock, StepWork<LANES>)>,
}

impl Batch {
    /// So many blocks of [`scattered`] particles with the scene's nominal friction.
    #[must_use]
    pub fn scattered(dynamics: &Dynamics, blocks: u32) -> Self {
        let block = |b: u32| {
            let mut chunks = FilterBlock::default();
            for i in 0..BLOCK {
                chunks[i / LANES].set(
                    i % LANES,
                    &scattered(b * BLOCK as u32 + i as u32),
                    &dynamics.scene().nominal,
                );
            }
            (chunks, StepWork::default())
        };
        Self {
            blocks: (0..blocks).map(block).collect(),
        }
    }

    /// Advances all particles by one step; returns the time per particle (ns).
    pub fn step(&mut self, dynamics: &Dynamics, input: &StepInput) -> f64 {
        let start = Instant::now();
        for (block, work) in &mut self.blocks {
            dynamics.step_block(input, block, work);
        }
        start.elapsed().as_nanos() as f64 / self.len() as f64
    }

    /// Number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.blocks.len() * BLOCK
    }

    /// True without a particle.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Outcome of the last step of each particle.
    pub fn reports(&self) -> impl Iterator<Item = &Report> {
        self.blocks
            .iter()
            .flat_map(|(_, work)| work.reports().as_flattened())
    }

    /// The first particle.
    #[must_use]
    pub fn first(&self) -> Option<Particle> {
        self.blocks.first().map(|(block, _)| block[0].get(0))
    }
}
