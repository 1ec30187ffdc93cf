//! A small dense front for Clarabel's interior-point method: [`ConicProgram`].

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus,
    SupportedConeT, ZeroConeT,
};

/// min ½ Σ weight_j x_j² + cost·x over A x + b in a product of cones, gathered row by row.
#[derive(Default)]
pub(crate) struct ConicProgram {
    pub weight: Vec<f64>,
    pub cost: Vec<f64>,
    rows: Vec<Vec<f64>>,
    offsets: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

/// Unknowns and, in the order of the rows, their multipliers (≥ 0 for inequalities).
pub(crate) struct Optimum {
    pub x: Vec<f64>,
    pub multipliers: Vec<f64>,
}

/// One affine expression: coefficients of the unknowns and a constant.
pub(crate) type Affine = (Vec<f64>, f64);

impl ConicProgram {
    /// A program in `n` unknowns without cost or constraint.
    pub fn new(n: usize) -> Self {
        Self {
            weight: vec![0.0; n],
            cost: vec![0.0; n],
            ..Self::default()
        }
    }

    /// Requires `row` = 0.
    pub fn equal(&mut self, row: Affine) {
        self.push(vec![row], ZeroConeT(1));
    }

    /// Requires `row` ≥ 0.
    pub fn at_least(&mut self, row: Affine) {
        self.push(vec![row], NonnegativeConeT(1));
    }

    /// Requires |`tail`| ≤ `head`.
    pub fn cone(&mut self, head: Affine, tail: [Affine; 2]) {
        let [a, b] = tail;
        self.push(vec![head, a, b], SecondOrderConeT(3));
    }

    fn push(&mut self, rows: Vec<Affine>, cone: SupportedConeT<f64>) {
        for (row, offset) in rows {
            // Clarabel writes the constraint as A x + s = b with s in the cone.
            self.rows.push(row.into_iter().map(|a| -a).collect());
            self.offsets.push(offset);
        }
        self.cones.push(cone);
    }

    /// Optima to the accuracy of doubles, one for each step length with which Clarabel does not
    /// give up; callers check them.
    ///
    /// On 4000 random steps Clarabel's defaults stalled at 86; with less regularisation, 0.9
    /// stalled at one, and no step at all three.
    pub fn attempts(&self) -> impl Iterator<Item = Optimum> {
        [0.9, 0.7, 0.99]
            .into_iter()
            .filter_map(|step_fraction| self.attempt(step_fraction))
    }

    fn attempt(&self, step_fraction: f64) -> Option<Optimum> {
        let n = self.weight.len();
        let square: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| if i == j { self.weight[i] } else { 0.0 })
                    .collect()
            })
            .collect();
        let (p, a) = (CscMatrix::from(&square), CscMatrix::from(&self.rows));
        let mut solver = DefaultSolver::new(
            &p,
            &self.cost,
            &a,
            &self.offsets,
            &self.cones,
            settings(step_fraction),
        )
        .ok()?;
        solver.solve();
        let done = matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
        );
        done.then(|| Optimum {
            x: solver.solution.x.clone(),
            multipliers: solver.solution.z.clone(),
        })
    }
}

/// As tight as doubles allow.
fn settings(step_fraction: f64) -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        max_step_fraction: step_fraction,
        static_regularization_constant: 1e-10,
        max_threads: 1,
        tol_gap_abs: 1e-14,
        tol_gap_rel: 1e-14,
        tol_feas: 1e-14,
        presolve_enable: false,
        ..DefaultSettings::default()
    }
}
