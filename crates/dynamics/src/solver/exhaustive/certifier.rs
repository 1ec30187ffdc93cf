//! Decides whether a candidate is a solution, within a limit on work: [`Certifier`].

use crate::solver::exhaustive::scalar_ncp::Candidate;
use crate::solver::vector::{Vector, add_scaled, norm};

/// Distance up to which V is the same (m/s).
const SAME: f64 = 1e-8;

/// Criterion by which a candidate is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// By its residual.
    AsItIs,
    /// By that of the point to which it refines.
    Refine,
}

/// Judgement of a candidate.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    /// True if it, or the point to which it refines, is a solution.
    pub certified: bool,
    /// Linear systems that it took.
    pub systems: u32,
}

/// Judges candidates, and keeps account of the work that a search may still take.
///
/// Work is counted in linear systems, each a fraction of a microsecond, not in seconds: so the
/// result of a search that runs out of it does not depend on the machine.
pub struct Certifier<'a> {
    judge: &'a mut dyn FnMut(&Candidate, Effort) -> Judged,
    left: u32,
    /// Velocities V at which candidates failed in this round, and how many failed there.
    failed: Vec<(Vector<4>, u32)>,
    patience: u32,
}

impl<'a> Certifier<'a> {
    /// With at most `limit` linear systems.
    pub fn new(judge: &'a mut dyn FnMut(&Candidate, Effort) -> Judged, limit: u32) -> Self {
        Self {
            judge,
            left: limit,
            failed: Vec::new(),
            patience: u32::MAX,
        }
    }

    /// Returns true if the candidate refines to a certified solution. Only a limited number is
    /// tried at the same V.
    pub fn certifies(&mut self, candidate: &Candidate) -> bool {
        let here = |(v, _): &&mut (Vector<4>, u32)| norm(&add_scaled(v, -1.0, &candidate.v)) < SAME;
        let failures = self.failed.iter_mut().find(here);
        if failures.as_ref().is_some_and(|(_, n)| *n >= self.patience) {
            return false;
        }
        let Judged { certified, systems } = (self.judge)(candidate, Effort::Refine);
        match failures {
            Some((_, n)) => *n += 1,
            None => self.failed.push((candidate.v, 1)),
        }
        self.spend(systems);
        certified
    }

    /// Returns true if the candidate is certified as it is.
    pub fn accepts(&mut self, candidate: &Candidate) -> bool {
        let Judged { certified, systems } = (self.judge)(candidate, Effort::AsItIs);
        self.spend(systems);
        certified
    }

    /// From here on, `patience` candidates are tried at the same V.
    pub fn begin_round(&mut self, patience: u32) {
        self.failed.clear();
        self.patience = patience;
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
