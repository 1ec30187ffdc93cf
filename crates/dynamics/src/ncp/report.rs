//! Outcome of one step, and facts about its answer: [`Report`].

/// Largest natural-map residual of a solved step (m/s).
pub const TOLERANCE: f64 = 1e-9;

/// Outcome of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// The residual is at most [`TOLERANCE`], and no speed is more than 30 times the fastest one
    /// that the problem asks for.
    Solved,
    /// It is proven that no such solution has impulses of at most 1e6 m/s times the mass; the
    /// velocity is that of the compliant problem.
    Infeasible,
    /// Neither a solution nor a proof was found within the limit on work; the velocity is that of
    /// the compliant problem.
    Failed,
}

/// The solver that the answer came from, in the order in which they are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Semismooth Newton iteration from the warm start.
    Newton,
    /// Path of smoothed solutions from the warm start.
    SmoothedPath,
    /// Exhaustive search over contact modes; where that finds neither a solution nor a proof, the
    /// first two from the free motion.
    ModeSearch,
}

/// Report of one particle's step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Its outcome.
    pub outcome: Outcome,
    /// Natural-map residual of the rigid problem (m/s).
    pub residual: f64,
    /// Linear systems solved for it.
    pub systems: u32,
    /// Solver that found the answer.
    pub route: Route,
}

impl Report {
    /// Of a step that no solver has tried yet.
    pub(crate) const UNSOLVED: Self = Self {
        outcome: Outcome::Failed,
        residual: f64::INFINITY,
        systems: 0,
        route: Route::Newton,
    };
}
