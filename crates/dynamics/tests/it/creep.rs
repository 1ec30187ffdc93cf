//! Contacts that creep: below its bound, friction is proportional to the slip (docs/method.md
//! (50)).

use stickslip_dynamics::{ContactPoint, Outcome, Route, StepProblem, TOLERANCE, Twist, solve};
use stickslip_testkit::{Corpus, residual_si};

/// A block that slides along a wall of friction 0.5 which it runs into at 0.1 m/s.
fn along_a_wall(vy: f64, creep: f64) -> StepProblem {
    let wall = ContactPoint {
        normal: [-1.0, 0.0],
        arm: [0.0; 2],
        gap: 0.0,
        mu: 0.5,
        creep,
        surface_velocity: [0.0; 2],
        on_pusher: false,
    };
    StepProblem {
        mass: 0.4,
        inertia: 3e-4,
        h: 0.01,
        twist: Twist {
            vx: 0.1,
            vy,
            omega: 0.0,
        },
        contacts: vec![wall],
        ..StepProblem::default()
    }
}

/// p_n = m vx stops the block. Friction takes p_t from m vy and leaves a slip of c p_t, so p_t = vy
/// / (1/m + c); at most it takes μ p_n.
#[test]
fn a_block_along_a_wall_slips_at_c_p_t_or_loses_mu_p_n() {
    for creep in [0.0, 0.1, 1.0, 10.0, 1e3] {
        for vy in [-0.2, -0.03, -1e-4, 1e-4, 0.03, 0.2] {
            let problem = along_a_wall(vy, creep);
            let (solution, report) = solve(&problem);
            let most: f64 = 0.5 * 0.4 * 0.1;
            let lost = (vy / (1.0 / 0.4 + creep)).clamp(-most, most);
            assert_eq!(report.outcome, Outcome::Solved, "c {creep}, vy {vy}");
            // the tangent is the normal turned to the left, here −y
            let off = (solution.tangential[0] - lost).abs() + (solution.normal[0] - 0.04).abs();
            assert!(off < 1e-9, "c {creep}, vy {vy}: {solution:?}");
            let left = vy - lost / 0.4;
            assert!(
                (solution.twist.vy - left).abs() < 1e-9,
                "c {creep}, vy {vy}: {solution:?}"
            );
        }
    }
}

/// The residual written from the model alone finds no fault with the solvers' answers to hard
/// problems whose contacts creep. The search over modes answers without creep.
#[test]
fn hard_problems_with_creep_are_solved_to_the_tolerance() {
    let corpus = Corpus { seed: 47 };
    let (mut solved, mut searched, mut crept) = (0, 0, 0);
    for index in 0..4000 {
        let mut problem = corpus.problem(index);
        for (i, contact) in problem.contacts.iter_mut().enumerate() {
            contact.creep = [0.01, 0.3, 10.0][i % 3] / problem.mass;
        }
        let (solution, report) = solve(&problem);
        if report.route == Route::ModeSearch {
            searched += 1;
            problem
                .contacts
                .iter_mut()
                .for_each(|contact| contact.creep = 0.0);
        }
        if report.outcome != Outcome::Solved {
            continue;
        }
        solved += 1;
        let residual = residual_si(&problem, &solution);
        assert!(
            residual <= 1.01 * TOLERANCE,
            "problem {index}: {residual:e}, {report:?}"
        );
        let within = |(contact, (p_n, p_t)): (&ContactPoint, (&f64, &f64))| {
            contact.creep > 0.0
                && *p_n > 0.0
                && p_t.abs() > 1e-6
                && p_t.abs() < 0.99 * contact.mu * p_n
        };
        let impulses = solution.normal.iter().zip(&solution.tangential);
        crept += usize::from(problem.contacts.iter().zip(impulses).any(within));
    }
    assert!(
        solved > 3000 && crept > 300,
        "{solved} solved, {crept} with a contact that creeps"
    );
    assert!(searched < 600, "{searched} went to the search");
}
