//! Highest speed of a solution that the solver seeks: [`speed_limit`], [`is_sought`],
//! [`judged_residual`].

use stickslip_dynamics::{StepProblem, StepSolution};

use crate::residual::residual_si;
use crate::scaled_problem::ScaledProblem;

/// Largest speed, in terms of the fastest one that the problem asks for (docs/method.md, "The
/// certificate").
const LIMIT: f64 = 30.0;
/// No problem's limit is less (m/s).
const LEAST: f64 = 1.0;
/// Impulses per mass up to which solutions are sought (m/s).
pub(crate) const LARGEST_IMPULSE: f64 = 1e6;

/// Largest component of a solution's velocity (vx, vy, ρω), and largest yield of the pusher (m/s).
#[must_use]
pub fn speed_limit(problem: &StepProblem) -> f64 {
    let scaled = ScaledProblem::new(problem);
    let approaches = problem.contacts.iter().map(|c| -scaled.gap_offset(c));
    let slips = problem.contacts.iter().map(|c| scaled.slip_offset(c).abs());
    let feet = (0..3).map(|k| scaled.bound(k));
    let free = scaled.free().map(f64::abs);
    let fastest = approaches.chain(slips).chain(feet).chain(free);
    (LIMIT * scaled.speed() * fastest.fold(0.0, f64::max)).max(LEAST)
}

/// Returns true if a solution is slow enough for its problem.
#[must_use]
pub fn is_sought(problem: &StepProblem, solution: &StepSolution) -> bool {
    let scaled = ScaledProblem::new(problem);
    let twist = scaled.scale_twist(solution.twist);
    let fastest = twist.iter().fold(0.0, |most, v| f64::max(most, v.abs()));
    (fastest * scaled.speed()).max(solution.pusher_yield) <= speed_limit(problem)
}

/// [`residual_si`] (m/s) of a solution, infinite where it is faster than any is sought.
#[must_use]
pub fn judged_residual(problem: &StepProblem, solution: &StepSolution) -> f64 {
    if is_sought(problem, solution) {
        residual_si(problem, solution)
    } else {
        f64::INFINITY
    }
}
