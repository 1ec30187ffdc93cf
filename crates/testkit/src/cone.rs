//! Frictionless contacts make the step a convex program: [`cone_program_step`].
//!
//! With μ = 0 at all contacts (1)–(2) are the optimality conditions of
//!
//! ```text
//! min over (v, y)  ½ (v − v_free)ᵀ M (v − v_free) + Σ_k b_k |J_k v| + F_stall h y
//! subject to       W_nᵀ v + ψ/h − n·(u − y d) ≥ 0,  y ≥ 0     (y = 0 without a stall limit)
//! ```
//!
//! strictly convex in v: the twist is unique. The multipliers are the impulses, so the answer comes
//! with its own certificate.

use stickslip_dynamics::{StepProblem, StepSolution, Twist};

use crate::conic_program::{ConicProgram, Optimum};
use crate::residual::residual_si;
use crate::scaled_problem::ScaledProblem;

/// Unknowns: z, y, and per foot the epigraph of |J_k z|.
const UNKNOWNS: usize = 7;
/// Worst accepted residual, relative to the problem's fastest speed; an interior point on a curved
/// cone reaches about 1e-8.
const ACCURACY: f64 = 1e-6;
const YIELD: usize = 3;
const EPIGRAPH: usize = 4;

/// The unique twist of a step whose contacts are all frictionless; `None` where there is none, or
/// only an absurdly fast one.
///
/// # Panics
/// Where a contact has friction.
#[must_use]
pub fn cone_program_twist(problem: &StepProblem) -> Option<Twist> {
    cone_program_step(problem).map(|solution| solution.twist)
}

/// The whole solution of a step whose contacts are all frictionless; `None` where there is none, or
/// only an absurdly fast one.
///
/// Its residual is below 1e-6 of the fastest speed in the problem, usually near 1e-9 of it.
///
/// # Panics
/// Where a contact has friction.
#[must_use]
pub fn cone_program_step(problem: &StepProblem) -> Option<StepSolution> {
    assert!(
        problem.contacts.iter().all(|c| c.mu == 0.0),
        "the step is a convex program only where no contact has friction"
    );
    let scaled = ScaledProblem::new(problem);
    let solves =
        |solution: &StepSolution| residual_si(problem, solution) < ACCURACY * scaled.speed();
    program(&scaled)
        .attempts()
        .map(|optimum| solution(&scaled, &optimum))
        .find(solves)
}

fn unit(j: usize, value: f64) -> Vec<f64> {
    let mut row = vec![0.0; UNKNOWNS];
    row[j] = value;
    row
}

fn bound_yield(scaled: &ScaledProblem, conic: &mut ConicProgram) {
    match scaled.stall_impulse() {
        Some(_) => conic.at_least((unit(YIELD, 1.0), 0.0)),
        None => conic.equal((unit(YIELD, 1.0), 0.0)),
    }
}

fn program(scaled: &ScaledProblem) -> ConicProgram {
    let mut conic = ConicProgram::new(UNKNOWNS);
    conic.weight[..3].fill(1.0);
    for (cost, free) in conic.cost.iter_mut().zip(scaled.free()) {
        *cost = -free;
    }
    conic.cost[YIELD] = scaled.stall_impulse().unwrap_or(0.0);
    for contact in &scaled.problem.contacts {
        let mut row = scaled.normal(contact).to_vec();
        row.push(scaled.yielding(contact, contact.normal));
        row.resize(UNKNOWNS, 0.0);
        conic.at_least((row, scaled.gap_offset(contact)));
    }
    for k in 0..3 {
        conic.cost[EPIGRAPH + k] = scaled.bound(k);
        let slip = scaled.foot(k).map(|column| {
            let mut row = column.to_vec();
            row.resize(UNKNOWNS, 0.0);
            (row, 0.0)
        });
        if scaled.bound(k) > 0.0 {
            conic.cone((unit(EPIGRAPH + k, 1.0), 0.0), slip);
        } else {
            conic.cone(
                (vec![0.0; UNKNOWNS], 1.0),
                [(unit(EPIGRAPH + k, 1.0), 0.0), (vec![0.0; UNKNOWNS], 0.0)],
            );
        }
    }
    bound_yield(scaled, &mut conic);
    conic
}

fn solution(scaled: &ScaledProblem, optimum: &Optimum) -> StepSolution {
    let contacts = scaled.problem.contacts.len();
    let impulse = |row: usize| optimum.multipliers[row] * scaled.impulse();
    let foot = |k: usize| {
        let row = contacts + 3 * k;
        if scaled.bound(k) > 0.0 {
            [impulse(row + 1), impulse(row + 2)]
        } else {
            [0.0; 2]
        }
    };
    let yielding = optimum.x[YIELD] * scaled.speed();
    StepSolution {
        twist: scaled.unscale_twist(&[optimum.x[0], optimum.x[1], optimum.x[2]]),
        normal: (0..contacts).map(impulse).collect(),
        tangential: vec![0.0; contacts],
        feet: [foot(0), foot(1), foot(2)],
        pusher_yield: if scaled.stall_impulse().is_some() {
            yielding
        } else {
            0.0
        },
    }
}
