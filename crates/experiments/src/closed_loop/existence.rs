//! Existence of a step's solution, by means that share nothing with the solver: [`Existence`].

use stickslip_dynamics::{StepProblem, StepSolution};

use stickslip_testkit::enumerate_modes;
use stickslip_testkit::is_sought;
use stickslip_testkit::residual_si;
use stickslip_testkit::{gap_margin, is_solvable};

/// Largest residual of a solution (m/s).
const TOLERANCE: f64 = 1e-9;

/// Contacts whose modes are enumerated.
const ENUMERATED: usize = 3;

/// Knowledge of a step's solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existence {
    /// There is one of a speed that is sought: no impulses within the friction cones cancel each
    /// other, and work bounds the speed, or one was found by enumeration.
    Certain,
    /// The gap rows exclude each other at every reasonable speed.
    Excluded,
    /// Neither is known.
    Unknown,
}

impl Existence {
    /// Of one step, from its gaps and friction cones alone: a fraction of a millisecond.
    ///
    /// # Panics
    /// Where Clarabel fails on a bounded program.
    #[must_use]
    pub fn of(problem: &StepProblem) -> Self {
        if gap_margin(problem, 1.0) < 0.0 {
            Self::Excluded
        } else if is_solvable(problem) {
            Self::Certain
        } else {
            Self::Unknown
        }
    }

    /// Of one step, where that says nothing also from the modes of its three nearest contacts, the
    /// others open: a third of a second.
    ///
    /// # Panics
    /// Where Clarabel fails on a bounded program.
    #[must_use]
    pub fn enumerated(problem: &StepProblem) -> Self {
        match Self::of(problem) {
            Self::Unknown if has_solution(problem) => Self::Certain,
            known => known,
        }
    }
}

/// Returns true if some mode of the nearest contacts gives a solution of the whole problem.
fn has_solution(problem: &StepProblem) -> bool {
    let gap = |i: &usize| problem.contacts[*i].gap;
    let mut nearest: Vec<usize> = (0..problem.contacts.len()).collect();
    nearest.sort_by(|a, b| gap(a).total_cmp(&gap(b)));
    nearest.truncate(ENUMERATED);
    let part = StepProblem {
        contacts: nearest.iter().map(|i| problem.contacts[*i]).collect(),
        ..problem.clone()
    };
    enumerate_modes(&part).iter().any(|found| {
        let whole = with_open(problem, &nearest, found);
        is_sought(problem, &whole) && residual_si(problem, &whole) <= TOLERANCE
    })
}

/// A solution of the contacts `closed`, with no impulse at the others.
fn with_open(problem: &StepProblem, closed: &[usize], found: &StepSolution) -> StepSolution {
    let mut whole = StepSolution {
        normal: vec![0.0; problem.contacts.len()],
        tangential: vec![0.0; problem.contacts.len()],
        ..found.clone()
    };
    for (k, i) in closed.iter().enumerate() {
        whole.normal[*i] = found.normal[k];
        whole.tangential[*i] = found.tangential[k];
    }
    whole
}
