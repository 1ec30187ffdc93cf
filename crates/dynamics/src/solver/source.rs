//! Where the problems of a block come from: [`Source`].

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;

/// Where the problems of a block come from, chunk by chunk.
pub trait Source<const W: usize> {
    /// Writes the problems of one chunk.
    fn load(&mut self, chunk: usize, ncp: &mut Ncp<W>);

    /// Writes the impulses from which their solution starts; zero is a cold start.
    fn start(&self, chunk: usize, ncp: &Ncp<W>, p: &mut Impulses<W>);
}
