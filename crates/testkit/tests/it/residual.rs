//! The residual on steps solved by hand: zero there, and every row and every unknown can spoil it.

use stickslip_dynamics::{ContactPoint, StepProblem, StepSolution, Twist, Wrench};
use stickslip_testkit::{Block, ResidualRow, residual_rows_si, residual_si};

const BLOCK: Block = Block {
    mass: 0.4,
    inertia: 3e-4,
    h: 0.01,
    mu_s: 0.25,
    gravity: 9.81,
    d_tri: 0.02,
};
const SPEED: f64 = 0.05;

fn push(mu: f64) -> ContactPoint {
    ContactPoint {
        normal: [1.0, 0.0],
        arm: [-0.03, 0.0],
        gap: 0.0,
        mu,
        surface_velocity: [SPEED, 0.0],
        yields: Some([1.0, 0.0]),
    }
}

/// A pusher drives the block from rest through its centre: v = u - y, p_n = m v + b, and a stalled
/// drive holds p_n = F_stall h.
fn pushed(mu: f64, stall_share: Option<f64>) -> (StepProblem, StepSolution) {
    let mut problem = BLOCK.problem(Twist::default(), Wrench::default());
    problem.contacts = vec![push(mu)];
    let needed = BLOCK.mass * SPEED + BLOCK.bound();
    let stall = stall_share.map(|share| share * needed);
    let force = stall.map_or(needed, |impulse| impulse.min(needed));
    let vx = (force - BLOCK.bound()) / BLOCK.mass;
    let solution = StepSolution {
        twist: Twist {
            vx,
            ..Twist::default()
        },
        normal: vec![force],
        tangential: vec![0.0],
        feet: [[-BLOCK.bound() / 3.0, 0.0]; 3],
        pusher_yield: if stall.is_some() { SPEED - vx } else { 0.0 },
    };
    problem.stall = stall;
    (problem, solution)
}

/// Every solution that differs from `solution` in one unknown, by `delta` in m/s or m/s times mass,
/// and that unknown's name.
fn perturbed(
    problem: &StepProblem,
    solution: &StepSolution,
    delta: f64,
) -> Vec<(String, StepSolution)> {
    let mut all = vec![];
    let mut add = |name: &str, change: &dyn Fn(&mut StepSolution)| {
        let mut other = solution.clone();
        change(&mut other);
        all.push((format!("{name} {delta:+e}"), other));
    };
    let (impulse, gyration) = (
        delta * problem.mass,
        (problem.inertia / problem.mass).sqrt(),
    );
    add("vx", &|s| s.twist.vx += delta);
    add("vy", &|s| s.twist.vy += delta);
    add("omega", &|s| s.twist.omega += delta / gyration);
    add("yield", &|s| s.pusher_yield += delta);
    for i in 0..problem.contacts.len() {
        add("normal", &|s| s.normal[i] += impulse);
        add("tangential", &|s| s.tangential[i] += impulse);
    }
    for (k, axis) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
        add("foot", &|s| s.feet[k][axis] += impulse);
    }
    all
}

#[test]
fn residual_of_hand_solved_pushes_is_rounding() {
    for (mu, stall) in [
        (0.0, None),
        (0.5, None),
        (0.5, Some(2.0)),
        (0.5, Some(0.9)),
        (0.0, Some(0.9)),
    ] {
        let (problem, solution) = pushed(mu, stall);
        assert!(
            residual_si(&problem, &solution) < 1e-15,
            "mu {mu}, stall {stall:?}: {:?}",
            residual_rows_si(&problem, &solution)
        );
    }
}

#[test]
fn residual_of_a_contact_that_opens_is_rounding() {
    let (mut problem, _) = BLOCK.slide_step(0.2, [1.0, 0.0]);
    problem.contacts = vec![ContactPoint {
        gap: 1e-4,
        ..push(0.4)
    }];
    let (_, mut solution) = BLOCK.slide_step(0.2, [1.0, 0.0]);
    solution.normal = vec![0.0];
    solution.tangential = vec![0.0];
    assert!(residual_si(&problem, &solution) < 1e-15);
}

#[test]
fn residual_grows_when_any_one_unknown_is_perturbed() {
    for (mu, stall) in [(0.0, None), (0.5, None), (0.5, Some(2.0)), (0.5, Some(0.9))] {
        let (problem, solution) = pushed(mu, stall);
        for delta in [1e-7, -1e-7, 1e-3, -1e-3] {
            for (name, other) in perturbed(&problem, &solution, delta) {
                let residual = residual_si(&problem, &other);
                assert!(
                    residual > 0.1 * delta.abs(),
                    "{name} at mu {mu}, stall {stall:?}: {residual:e}"
                );
            }
        }
    }
}

#[test]
fn residual_every_row_can_fail() {
    let (problem, solution) = pushed(0.5, Some(0.9));
    let mut failing = vec![];
    for (_, other) in perturbed(&problem, &solution, 1e-3) {
        failing.extend(
            residual_rows_si(&problem, &other)
                .into_iter()
                .filter(|(_, value)| *value > 1e-5)
                .map(|(row, _)| row),
        );
    }
    for (row, _) in residual_rows_si(&problem, &solution) {
        assert!(failing.contains(&row), "{row:?} never fails");
    }
    assert!(failing.contains(&ResidualRow::Stall));
}

#[test]
fn residual_slip_row_knows_the_sign_of_friction() {
    let (mut problem, solution) = pushed(0.5, None);
    problem.contacts[0].surface_velocity[1] = 0.3;
    let rows = residual_rows_si(&problem, &solution);
    let slip = rows
        .iter()
        .find(|(row, _)| *row == ResidualRow::Slip(0))
        .expect("a row")
        .1;
    let limit = 0.5 * solution.normal[0] / problem.mass;
    assert!((slip - limit.min(0.3)).abs() < 1e-15);
}

#[test]
fn residual_of_yield_without_stall_limit_is_the_yield() {
    let (problem, mut solution) = pushed(0.0, None);
    solution.pusher_yield = -2e-4;
    assert!((residual_si(&problem, &solution) - 2e-4).abs() < 1e-15);
}

#[test]
fn residual_of_numbers_that_are_not_finite_is_infinite() {
    for bad in [f64::NAN, f64::INFINITY] {
        let (problem, mut solution) = pushed(0.5, None);
        solution.normal[0] = bad;
        assert_eq!(residual_si(&problem, &solution), f64::INFINITY);
    }
}
