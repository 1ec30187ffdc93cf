//! Nonlinear least squares by Levenberg–Marquardt: [`minimise`].

/// Unknowns whose sum of squared residuals is to be least.
pub(crate) trait LeastSquares: Sized {
    /// Normal equations about the unknowns.
    type Equations;

    /// The equations; `None` where a residual is not defined.
    fn equations(&self) -> Option<Self::Equations>;

    /// Sum of squared residuals.
    fn squares(equations: &Self::Equations) -> f64;

    /// The step that solves the equations with their diagonal raised by a share `damping` of
    /// itself; `None` where they are singular.
    fn step(&self, equations: &Self::Equations, damping: f64) -> Option<Step<Self>>;
}

/// Result of a step.
pub(crate) enum Step<P> {
    /// To these unknowns.
    To(P),
    /// Nowhere: it is too small to matter.
    Negligible,
}

/// Start and end of the iteration.
pub(crate) struct Rules {
    /// Damping of the first step.
    pub(crate) damping: f64,
    /// Damping beyond which no further step is tried.
    pub(crate) most_damping: f64,
    /// The minimum is found where a step decreases the squares by less than this share of them.
    pub(crate) least_decrease: f64,
    /// Most steps.
    pub(crate) iterations: usize,
}

/// End of an iteration.
pub(crate) struct Minimum<P: LeastSquares> {
    /// The unknowns.
    pub(crate) at: P,
    /// The equations about them.
    pub(crate) equations: P::Equations,
    /// True if the minimum was found, not only approached.
    pub(crate) converged: bool,
}

/// The minimum near `start`; `None` where the equations do not determine a step.
pub(crate) fn minimise<P: LeastSquares>(start: P, rules: &Rules) -> Option<Minimum<P>> {
    let mut damping = rules.damping;
    let mut minimum = Minimum {
        equations: start.equations()?,
        at: start,
        converged: false,
    };
    for _ in 0..rules.iterations {
        let Step::To(next) = minimum.at.step(&minimum.equations, damping)? else {
            minimum.converged = true;
            break;
        };
        let before = P::squares(&minimum.equations);
        if let Some(equations) = next.equations().filter(|e| P::squares(e) < before) {
            let after = P::squares(&equations);
            (minimum.at, minimum.equations, damping) = (next, equations, damping * 0.1);
            minimum.converged = before - after < rules.least_decrease * after;
            if minimum.converged {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > rules.most_damping {
                break;
            }
        }
    }
    Some(minimum)
}
