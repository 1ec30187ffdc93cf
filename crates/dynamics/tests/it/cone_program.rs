//! Steps without friction at their contacts against a convex program, whose twist is unique.

use crate::common::{fastest, twist_distance};
use stickslip_dynamics::{Outcome, StepProblem, solve};
use stickslip_testkit::{Corpus, Family, cone_program_step, is_sought};

const CORPUS: Corpus = Corpus { seed: 5 };

fn frictionless(mut problem: StepProblem) -> StepProblem {
    problem
        .contacts
        .iter_mut()
        .for_each(|contact| contact.mu = 0.0);
    problem
}

#[test]
fn solve_frictionless_contacts_is_the_optimum_of_the_cone_program() {
    let (mut compared, mut infeasible) = (0, 0);
    for index in 0..50 * Family::ALL.len() as u64 {
        let problem = frictionless(CORPUS.problem(index));
        if problem.contacts.is_empty() {
            continue;
        }
        let (solution, report) = solve(&problem);
        // faster ones are not sought
        let optimum = cone_program_step(&problem).filter(|it| is_sought(&problem, it));
        match (report.outcome, optimum) {
            (Outcome::Solved, Some(optimum)) => {
                let error = twist_distance(&problem, solution.twist, optimum.twist);
                assert!(
                    error <= 1e-6 * (1.0 + fastest(&problem)),
                    "{:?} {index}: {error:e}",
                    CORPUS.family(index)
                );
                compared += 1;
            }
            (outcome, optimum) => {
                assert_eq!(
                    (outcome, optimum),
                    (Outcome::Infeasible, None),
                    "{:?} {index}",
                    CORPUS.family(index)
                );
                infeasible += 1;
            }
        }
    }
    assert!(
        compared > 600 && infeasible > 5,
        "{compared} compared, {infeasible} infeasible"
    );
}
