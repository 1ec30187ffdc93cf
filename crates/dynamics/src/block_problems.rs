//! The contact problems of a block of particles: [`BlockProblems`].

use stickslip_lanes::Mask;

use crate::assembly::Assembly;
use crate::geometry::narrow_phase::NarrowPhase;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::particles::Particles;
use crate::prepared_scene::{PreparedScene, Pushers, StepBodies, StepContext};
use crate::solver::source::Source;

/// The problems of some chunks of particles.
pub struct BlockProblems<'a, const W: usize> {
    /// The scene.
    pub scene: &'a PreparedScene,
    /// Step length that all particles share.
    pub context: StepContext,
    /// Their pushers.
    pub pushers: &'a Pushers<'a, W>,
    /// Number of the first chunk.
    pub first: usize,
    /// The lanes whose answers count.
    pub asked: Mask<W>,
    /// The particles.
    pub particles: &'a [Particles<W>],
    /// Contacts of each chunk, kept from one step to the next.
    pub chunks: &'a mut [Assembly<W>],
    /// Finds contacts.
    pub narrow: &'a mut NarrowPhase<W>,
}

impl<const W: usize> Source<W> for BlockProblems<'_, W> {
    #[inline(always)]
    fn load(&mut self, chunk: usize, ncp: &mut Ncp<W>) {
        self.chunks[chunk].collect(
            self.scene,
            StepBodies {
                context: &self.context,
                pushers: self.pushers,
                chunk: self.first + chunk,
                fixel_offsets: self.pushers.fixel_offsets(self.first + chunk),
                support: self.pushers.support(self.first + chunk),
            },
            &self.particles[chunk],
            self.narrow,
            ncp,
        );
    }

    #[inline(always)]
    fn start(&self, chunk: usize, _: &Ncp<W>, p: &mut Unknowns<W>) {
        self.chunks[chunk].load_warm_start(self.scene.rho, &self.particles[chunk], p);
    }

    #[inline(always)]
    fn asked(&self) -> Mask<W> {
        self.asked
    }
}
