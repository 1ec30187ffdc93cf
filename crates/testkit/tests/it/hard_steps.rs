//! The steps that a solver once failed on or took long for, from where it started and from afar:
//! each is solved or proven to have no solution, and the two agree.

use stickslip_dynamics::{Outcome, Route, solve, solve_from};
use stickslip_testkit::{gap_margin, hard_steps, is_solvable, is_sought, may_jam, residual_si};

/// Largest residual of a solved step (m/s).
const TOLERANCE: f64 = 1e-9;

/// Linear systems within which each is decided: the limit for the search of a step of a block.
const MOST_SYSTEMS: u32 = 6_000;

#[test]
fn hard_steps_are_solved_or_proven_infeasible() {
    let steps = hard_steps();
    let (mut infeasible, mut searched) = (0, 0);
    for (k, step) in steps.iter().enumerate() {
        let answers = [solve(&step.problem), solve_from(&step.problem, &step.start)];
        for (solution, report) in &answers {
            let residual = residual_si(&step.problem, solution);
            match report.outcome {
                // the two residuals may differ by rounding
                Outcome::Solved => {
                    assert!(residual <= 1.1 * TOLERANCE, "{k}: {residual:e}");
                    assert!(is_sought(&step.problem, solution), "{k}: {solution:?}");
                }
                Outcome::Infeasible => infeasible += 1,
                Outcome::Failed => panic!("{k}, {}: failed", step.class),
            }
            assert!(
                report.systems <= MOST_SYSTEMS,
                "{k}, {}: {} systems",
                step.class,
                report.systems
            );
            searched += usize::from(report.route == Route::ModeSearch);
        }
        assert_eq!(
            answers[0].1.outcome, answers[1].1.outcome,
            "{k}, {}",
            step.class
        );
        if step.class == "fast" {
            assert_eq!(answers[0].1.outcome, Outcome::Infeasible, "{k}");
        } else if step.class == "solved" {
            assert_eq!(answers[0].1.outcome, Outcome::Solved, "{k}");
        }
        // an independent proof, where there is one, says the same
        let margin = gap_margin(&step.problem, 1.0);
        let has_solution = margin > 0.0 && !may_jam(&step.problem);
        if margin < -1e-6 {
            assert_eq!(answers[0].1.outcome, Outcome::Infeasible, "{k}");
        } else if is_solvable(&step.problem) || has_solution && step.class != "fast" {
            assert_eq!(answers[0].1.outcome, Outcome::Solved, "{k}");
        }
    }
    // the file has not lost what makes it hard
    assert!(steps.len() > 250, "{} steps", steps.len());
    assert!(
        infeasible > 150 && searched > 300,
        "{infeasible}, {searched}"
    );
}

#[test]
fn drives_that_no_jam_makes_yield_count_as_rigid() {
    let rigid = hard_steps()
        .into_iter()
        .filter(|step| step.problem.stall.is_none());
    let mut infeasible = 0;
    for step in rigid {
        let mut strong = step.problem.clone();
        strong.stall = Some(1e8);
        for yields in strong.contacts.iter_mut().flat_map(|c| &mut c.yields) {
            *yields = [1.0, 0.0];
        }
        let (outcome, expected) = (solve(&strong).1.outcome, solve(&step.problem).1.outcome);
        assert_eq!(outcome, expected, "{strong:?}");
        infeasible += u32::from(outcome == Outcome::Infeasible);
    }
    assert!(infeasible > 10, "{infeasible}");
}
