//! Decides whether a candidate is a solution, within a limit on work: [`Certifier`].

use crate::solver::scalar_ncp::Candidate;

/// A candidate's refinement.
#[derive(Clone, Copy, Debug)]
pub struct Refined {
    /// Whether its residual is small enough.
    pub certified: bool,
    /// Linear systems that it took.
    pub systems: u32,
}

/// Refines candidates, and keeps account of the work that a search may still take.
///
/// Work is counted in linear systems, each a fraction of a microsecond, not in seconds: so the
/// result of a search that runs out of it does not depend on the machine.
pub struct Certifier<'a> {
    refine: &'a mut dyn FnMut(&Candidate) -> Refined,
    left: u32,
}

impl<'a> Certifier<'a> {
    /// With at most `limit` linear systems.
    pub fn new(refine: &'a mut dyn FnMut(&Candidate) -> Refined, limit: u32) -> Self {
        Self {
            refine,
            left: limit,
        }
    }

    /// Whether the candidate refines to a certified solution.
    pub fn certifies(&mut self, candidate: &Candidate) -> bool {
        let Refined { certified, systems } = (self.refine)(candidate);
        self.spend(systems);
        certified
    }

    /// Takes work from what is left.
    pub fn spend(&mut self, systems: u32) {
        self.left = self.left.saturating_sub(systems);
    }

    /// Linear systems left.
    pub fn left(&self) -> u32 {
        self.left
    }
}
