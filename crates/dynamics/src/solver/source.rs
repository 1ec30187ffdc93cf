//! Source of the problems of a block: [`Source`].

use stickslip_lanes::Mask;

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;

/// Source of the problems of a block, chunk by chunk.
pub trait Source<const W: usize> {
    /// Writes the problems of one chunk.
    fn load(&mut self, chunk: usize, ncp: &mut Ncp<W>);

    /// Writes the unknowns from which their solvers start.
    fn start(&self, chunk: usize, ncp: &Ncp<W>, z: &mut Unknowns<W>);

    /// The lanes whose answers count; no time is spent on others that take long.
    fn asked(&self) -> Mask<W> {
        Mask::splat(true)
    }
}
