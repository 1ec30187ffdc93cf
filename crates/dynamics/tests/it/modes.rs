//! Steps with one and two frictional contacts against the list of all their solutions, found by
//! trying every contact mode.

use crate::common::{fastest, twist_distance};
use stickslip_dynamics::{Outcome, solve};
use stickslip_testkit::{Corpus, Family, enumerate_modes, is_sought, residual_si};

const CORPUS: Corpus = Corpus { seed: 3 };

#[test]
fn solve_up_to_two_contacts_is_one_of_the_enumerated_solutions() {
    let (mut compared, mut ambiguous, mut unlisted, mut infeasible) = (0, 0, 0, 0);
    for index in 0..30 * Family::ALL.len() as u64 {
        let problem = CORPUS.problem(index);
        if !(1..=2).contains(&problem.contacts.len())
            || problem.contacts.iter().all(|c| c.mu == 0.0)
        {
            continue;
        }
        let (solution, report) = solve(&problem);
        let mut all = enumerate_modes(&problem);
        all.retain(|solution| is_sought(&problem, solution));
        if report.outcome == Outcome::Solved {
            let error = all
                .iter()
                .map(|known| twist_distance(&problem, known.twist, solution.twist))
                .fold(f64::INFINITY, f64::min);
            let listed = error <= 1e-7 * (1.0 + fastest(&problem));
            // Of several solutions the enumeration may miss one; of a single one it may not.
            let missed = all.len() > 1 && residual_si(&problem, &solution) <= 1e-10;
            assert!(
                listed || missed,
                "{:?} {index}: {error:e} from all {}",
                CORPUS.family(index),
                all.len()
            );
            compared += 1;
            ambiguous += u32::from(all.len() > 1);
            unlisted += u32::from(!listed);
        } else {
            assert_eq!(
                report.outcome,
                Outcome::Infeasible,
                "{:?} {index}",
                CORPUS.family(index)
            );
            assert!(
                all.is_empty(),
                "{:?} {index}: said to be infeasible, but has {} solutions",
                CORPUS.family(index),
                all.len()
            );
            infeasible += 1;
        }
    }
    assert!(
        unlisted <= compared / 100,
        "{unlisted} of {compared} are not listed"
    );
    assert!(
        compared > 300 && ambiguous > 0 && infeasible > 1,
        "{compared} compared, {ambiguous} ambiguous, {infeasible} infeasible"
    );
}
