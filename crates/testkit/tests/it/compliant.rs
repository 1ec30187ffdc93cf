//! Answer of the solver where it proves that there is no solution: the solution with compliant gap
//! rows, and nothing else.

use stickslip_dynamics::{Outcome, StepProblem, StepSolution, Twist, solve};
use stickslip_testkit::{Corpus, residual_si};

const CORPUS: Corpus = Corpus { seed: 1 };

/// κ of docs/method.md (14).
const COMPLIANCE: f64 = 1e-6;

/// The softest that the solver tries.
const SOFTEST: f64 = 1e4;

/// The residual of a problem with gap rows W_nᵀ v + ψ/h + ∂ψ/∂t + κ p_n/m at `solution`.
fn compliant_residual(problem: &StepProblem, solution: &StepSolution, compliance: f64) -> f64 {
    let mut compliant = problem.clone();
    for (contact, p_n) in compliant.contacts.iter_mut().zip(&solution.normal) {
        contact.gap += problem.h * compliance * p_n / problem.mass;
    }
    residual_si(&compliant, solution)
}

/// The κ for which the contact that presses most is closed; `None` where none presses.
fn compliance_of(problem: &StepProblem, solution: &StepSolution) -> Option<f64> {
    let (contact, p_n) = problem
        .contacts
        .iter()
        .zip(&solution.normal)
        .max_by(|a, b| a.1.total_cmp(b.1))
        .filter(|(_, p_n)| **p_n > 0.0)?;
    let Twist { vx, vy, omega } = solution.twist;
    let [x, y] = contact.arm;
    let yields = contact.yields.filter(|_| problem.stall.is_some());
    let give = yields.map_or([0.0; 2], |yields| yields.map(|d| d * solution.pusher_yield));
    let relative = [
        vx - omega * y - contact.surface_velocity[0] + give[0],
        vy + omega * x - contact.surface_velocity[1] + give[1],
    ];
    let along = contact.normal[0] * relative[0] + contact.normal[1] * relative[1];
    Some(-(along + contact.gap / problem.h) * problem.mass / p_n)
}

/// The largest normal impulse, as a speed (m/s): rounding grows with it.
fn largest_impulse(problem: &StepProblem, solution: &StepSolution) -> f64 {
    solution
        .normal
        .iter()
        .fold(0.0, |largest, p_n| f64::max(largest, p_n / problem.mass))
}

/// Nearly always with κ itself; else with a softer one, where the solver found none for κ.
#[test]
fn infeasible_steps_are_answered_by_a_compliant_problem() {
    let (mut answered, mut softer) = (0, 0);
    for index in 0..6000 {
        let problem = CORPUS.problem(index);
        let (solution, report) = solve(&problem);
        if report.outcome != Outcome::Infeasible {
            continue;
        }
        let impulse = largest_impulse(&problem, &solution);
        let tolerance = 1e-9 + 3e-11 * impulse;
        if compliant_residual(&problem, &solution, COMPLIANCE) > tolerance {
            let compliance = compliance_of(&problem, &solution).unwrap_or(SOFTEST);
            let residual = compliant_residual(&problem, &solution, compliance);
            assert!(
                residual <= tolerance && (COMPLIANCE..=1.01 * SOFTEST).contains(&compliance),
                "{:?} {index}: {residual:e} at {impulse:e} m/s, compliance {compliance:e}",
                CORPUS.family(index)
            );
            softer += 1;
        }
        let rigid = residual_si(&problem, &solution);
        assert!(
            (rigid - report.residual).abs() <= 1e-12 * impulse.max(1.0),
            "{index}: the rigid rows miss by {rigid:e}, not {:e}",
            report.residual
        );
        answered += 1;
    }
    assert!(answered > 400, "{answered}");
    assert!(softer * 50 <= answered, "{softer} of {answered}");
}
