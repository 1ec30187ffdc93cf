//! The solver over hard random problems: every one is solved or proven to have no solution, and no
//! proof contradicts a known solution.

use stickslip_dynamics::TOLERANCE;
use stickslip_testkit::{Corpus, Family, survey};

#[test]
fn solve_twenty_thousand_hard_problems_are_solved_or_proven_infeasible() {
    let tallies = survey(&Corpus { seed: 1 }, 0..20_000);
    assert_eq!(tallies.len(), Family::ALL.len());
    for (family, tally) in &tallies {
        assert_eq!(
            tally.failed, [0; 0],
            "{family:?}: neither solved nor proven infeasible"
        );
        assert_eq!(
            tally.contradicted, [0; 0],
            "{family:?}: said to be infeasible although a solution is known"
        );
        assert!(
            tally.worst_residual <= TOLERANCE,
            "{family:?}: residual {:e}",
            tally.worst_residual
        );
        assert_eq!(
            tally.solved.iter().sum::<u64>() + tally.infeasible,
            tally.problems,
            "{family:?}: every problem is counted"
        );
    }
    // Families that have a solution by construction.
    for family in [
        Family::Resting,
        Family::Pivoting,
        Family::Manufactured,
        Family::Sliding,
    ] {
        assert_eq!(tallies[&family].infeasible, 0, "{family:?}");
    }
}
