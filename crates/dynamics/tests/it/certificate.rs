//! The solver's certificate, computed in mass-normalised lanes, against the residual that testkit
//! writes from the model in SI units.

use crate::common;
use crate::common::normalised;
use stickslip_dynamics::{Ncp, Outcome, StepProblem, StepSolution, TOLERANCE, solve};
use stickslip_testkit::{Corpus, Family, residual_si};

const CORPUS: Corpus = Corpus { seed: 7 };
const ROUNDS: u64 = 150;

fn indices() -> std::ops::Range<u64> {
    0..ROUNDS * Family::ALL.len() as u64
}

fn certificate(problem: &StepProblem, solution: &StepSolution) -> f64 {
    let mut ncp = Ncp::<1>::default();
    ncp.assign(std::array::from_ref(problem));
    ncp.residual(&normalised(problem, solution)).0[0]
}

/// The largest number [m/s] that enters the rows.
fn magnitude(problem: &StepProblem, solution: &StepSolution) -> f64 {
    let p = normalised(problem, solution);
    let impulses = p
        .normal
        .iter()
        .chain(&p.tangential)
        .chain(p.feet.as_flattened())
        .chain(&p.v)
        .map(|x| x.0[0]);
    let gaps = problem.contacts.iter().map(|c| c.gap / problem.h);
    impulses
        .chain(gaps)
        .map(f64::abs)
        .fold(common::fastest(problem), f64::max)
}

/// Both residuals are sums of a few dozen terms; 1e-12 of the largest one leaves their rounding
/// room.
#[track_caller]
fn assert_agree(problem: &StepProblem, solution: &StepSolution, ours: f64, what: &str) {
    let theirs = residual_si(problem, solution);
    let tolerance = 1e-12 * (1.0 + magnitude(problem, solution));
    assert!(
        (ours - theirs).abs() <= tolerance,
        "{what}: {ours:e} here, {theirs:e} from the model"
    );
}

/// Number of unknowns of a solution.
fn unknowns(solution: &StepSolution) -> usize {
    10 + 2 * solution.normal.len()
}

/// Adds `speed` [m/s] to unknown `j`, in its own unit.
fn disturb(problem: &StepProblem, solution: &mut StepSolution, j: usize, speed: f64) {
    let (m, gyration) = (problem.mass, (problem.inertia / problem.mass).sqrt());
    let contacts = solution.normal.len();
    match j {
        0 => solution.twist.vx += speed,
        1 => solution.twist.vy += speed,
        2 => solution.twist.omega += speed / gyration,
        3..9 => solution.feet.as_flattened_mut()[j - 3] += m * speed,
        9 => solution.pusher_yield += speed,
        _ if j < 10 + contacts => solution.normal[j - 10] += m * speed,
        _ => solution.tangential[j - 10 - contacts] += m * speed,
    }
}

#[test]
fn report_residual_of_every_answer_is_the_one_of_the_model() {
    let mut solved = 0;
    for index in indices() {
        let problem = CORPUS.problem(index);
        let (solution, report) = solve(&problem);
        assert_agree(
            &problem,
            &solution,
            report.residual,
            &format!("problem {index}"),
        );
        assert_eq!(
            report.outcome == Outcome::Solved,
            report.residual <= TOLERANCE,
            "problem {index}"
        );
        solved += u32::from(report.outcome == Outcome::Solved);
    }
    assert!(solved > 3000, "only {solved} solved");
}

#[test]
fn residual_of_disturbed_solutions_is_the_one_of_the_model() {
    for index in indices() {
        let problem = CORPUS.problem(index);
        let (solution, _) = solve(&problem);
        for j in 0..unknowns(&solution) {
            for speed in [1e-7, -1e-3, 0.3] {
                let mut disturbed = solution.clone();
                disturb(&problem, &mut disturbed, j, speed);
                let ours = certificate(&problem, &disturbed);
                assert_agree(
                    &problem,
                    &disturbed,
                    ours,
                    &format!("problem {index}, unknown {j} off by {speed}"),
                );
            }
        }
    }
}

#[test]
fn residual_notices_every_unknown_that_is_off() {
    for index in indices() {
        let problem = CORPUS.problem(index);
        let (solution, report) = solve(&problem);
        for j in (0..unknowns(&solution)).filter(|&j| j != 9 || problem.stall.is_none()) {
            let mut disturbed = solution.clone();
            disturb(&problem, &mut disturbed, j, 1e-3);
            // Newton–Euler rows see at least the larger component of a unit vector of the plane;
            // rows that were off may cancel it.
            let seen = certificate(&problem, &disturbed) + report.residual;
            assert!(
                seen > 0.7e-3,
                "problem {index}, unknown {j} off by 1e-3: residual {seen:e}"
            );
        }
    }
}

#[test]
fn residual_of_numbers_that_are_not_finite_is_infinite() {
    let problem = CORPUS.problem(4);
    let (solution, _) = solve(&problem);
    for j in 0..unknowns(&solution) {
        let mut disturbed = solution.clone();
        disturb(&problem, &mut disturbed, j, f64::NAN);
        assert_eq!(
            certificate(&problem, &disturbed),
            f64::INFINITY,
            "unknown {j}"
        );
    }
}
