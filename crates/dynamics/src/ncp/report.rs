//! How one step ended, and what is known of its answer: [`Report`].

/// Largest natural-map residual of a solved step (m/s).
pub const TOLERANCE: f64 = 1e-9;

/// How one step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// The residual is at most [`TOLERANCE`].
    Solved,
    /// It is proven that no solution exists; the velocity is that of the compliant problem.
    Infeasible,
    /// Neither a solution nor a proof was found; the velocity is that of the compliant problem.
    Failed,
}

/// Which solver the answer came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Semismooth Newton from the warm start.
    Newton,
    /// Smoothed Newton steps from the warm start.
    Continuation,
    /// Smoothing homotopy, polished.
    Homotopy,
    /// Exhaustive search over contact modes.
    Modes,
}

/// What is known of one particle's step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Natural-map residual of the rigid problem (m/s).
    pub residual: f64,
    /// Newton steps of the solvers that run side by side.
    pub iterations: u32,
    /// Where the answer came from.
    pub route: Route,
}

impl Report {
    /// Of a step that no solver has looked at.
    pub(crate) const UNSOLVED: Self = Self {
        outcome: Outcome::Failed,
        residual: f64::INFINITY,
        iterations: 0,
        route: Route::Newton,
    };
}
