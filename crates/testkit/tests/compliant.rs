//! What the solver answers where it proves that there is no solution: the solution with compliant
//! gap rows, and nothing else.

use stickslip_dynamics::{Outcome, StepProblem, StepSolution, solve};
use stickslip_testkit::{Corpus, residual_si};

const CORPUS: Corpus = Corpus { seed: 1 };

/// κ of docs/method.md (14).
const COMPLIANCE: f64 = 1e-6;

/// The residual of a problem with compliant gap rows, W_nᵀ v + ψ/h + ∂ψ/∂t + κ p_n/m, at
/// `solution`.
fn compliant_residual(problem: &StepProblem, solution: &StepSolution) -> f64 {
    let mut compliant = problem.clone();
    for (contact, p_n) in compliant.contacts.iter_mut().zip(&solution.normal) {
        contact.gap += problem.h * COMPLIANCE * p_n / problem.mass;
    }
    residual_si(&compliant, solution)
}

/// The largest normal impulse, as a speed (m/s): rounding grows with it.
fn largest_impulse(problem: &StepProblem, solution: &StepSolution) -> f64 {
    solution
        .normal
        .iter()
        .fold(0.0, |largest, p_n| f64::max(largest, p_n / problem.mass))
}

#[test]
fn infeasible_steps_are_answered_by_the_compliant_problem() {
    let mut answered = 0;
    for index in 0..6000 {
        let problem = CORPUS.problem(index);
        let (solution, report) = solve(&problem);
        if report.outcome != Outcome::Infeasible {
            continue;
        }
        let (residual, impulse) = (
            compliant_residual(&problem, &solution),
            largest_impulse(&problem, &solution),
        );
        assert!(
            residual <= 1e-9 + 3e-11 * impulse,
            "{:?} {index}: {residual:e} at {impulse:e} m/s",
            CORPUS.family(index)
        );
        let rigid = residual_si(&problem, &solution);
        assert!(
            (rigid - report.residual).abs() <= 1e-12 * impulse,
            "{index}: the rigid rows miss by {rigid:e}, not {:e}",
            report.residual
        );
        answered += 1;
    }
    assert!(answered > 400, "{answered}");
}
