//! When a step can fail to have a solution: [`gap_margin`] and [`may_jam`].
//!
//! Two one-sided answers. Below zero margin the gap rows exclude each other, at any reasonable
//! speed: no solution. Where the friction cones admit no impulses that cancel each other (their sum
//! is a pointed cone) there is always a solution: impulses p that grow without bound along a
//! homotopy would have W p/|p| tend to zero. In between, jamming by friction, both are silent.
//! Faces that close on an object at a slight angle meet both conditions: their solution squeezes it
//! out at an absurd speed. So a step *must* be solved where `!may_jam(p) && gap_margin(p, cap) >
//! 0`.

use stickslip_dynamics::StepProblem;

use crate::conic_program::ConicProgram;
use crate::scaled_problem::ScaledProblem;
use crate::vector::left;

/// Twists up to this many times the problem's fastest speed are considered.
const FASTEST_TWIST: f64 = 100.0;
/// Wrenches of unit impulses that sum to less than this may cancel each other; the quadratic
/// program is good to about 1e-7.
const CANCELLED: f64 = 1e-5;

/// How fast all gaps can open at once (m/s), at most `cap`, with twists up to 100 times the fastest
/// speed in the problem.
///
/// Negative where the gap rows exclude each other: then there is no solution of such a speed,
/// whatever the friction.
///
/// # Panics
/// Where Clarabel fails on this bounded linear program.
#[must_use]
pub fn gap_margin(problem: &StepProblem, cap: f64) -> f64 {
    let scaled = ScaledProblem::new(problem);
    let cap = cap / scaled.speed();
    // unknowns: z, y and the margin
    let mut conic = ConicProgram::new(5);
    conic.cost[4] = -1.0;
    for contact in &problem.contacts {
        let [x, y, turn] = scaled.normal(contact);
        // gaps wider than any twist can close never bind; large numbers would cost accuracy
        let offset = scaled.gap_offset(contact).min(cap + 10.0 * FASTEST_TWIST);
        conic.at_least((
            vec![x, y, turn, scaled.yielding(contact, contact.normal), -1.0],
            offset,
        ));
    }
    let limits = if problem.stall.is_some() {
        [FASTEST_TWIST; 4]
    } else {
        [FASTEST_TWIST, FASTEST_TWIST, FASTEST_TWIST, 0.0]
    };
    for (j, limit) in limits.into_iter().enumerate() {
        conic.at_least((unit(j, -1.0), limit));
        conic.at_least((unit(j, 1.0), if j == 3 { 0.0 } else { limit }));
    }
    conic.at_least((unit(4, -1.0), cap));
    let optimum = conic.attempts().next().expect("a bounded linear program");
    optimum.x[4] * scaled.speed()
}

fn unit(j: usize, value: f64) -> Vec<f64> {
    let mut row = vec![0.0; 5];
    row[j] = value;
    row
}

/// Whether impulses within the friction cones can cancel each other while a drive with a force
/// limit does not push.
///
/// Where they cannot, a solution exists; one of reasonable speed where [`gap_margin`] is positive
/// too, and a solver that then reports none is at fault. Impulses that cancel to 1e-5 of their size
/// count as cancelling, open contacts as closed.
///
/// # Panics
/// Where Clarabel fails on this bounded quadratic program.
#[must_use]
pub fn may_jam(problem: &StepProblem) -> bool {
    !problem.contacts.is_empty() && least_wrench(problem) < CANCELLED
}

/// Least size of the sum of wrenches, and of the push along the drive, of impulses whose normal
/// parts sum to one.
fn least_wrench(problem: &StepProblem) -> f64 {
    let (scaled, contacts) = (ScaledProblem::new(problem), problem.contacts.len());
    // unknowns: p_n, p_t per contact, then the wrench, then the push
    let (wrench, n) = (2 * contacts, 2 * contacts + 4);
    let mut conic = ConicProgram::new(n);
    conic.weight[wrench..wrench + 3].fill(1.0);
    conic.cost[wrench + 3] = 1.0;
    let mut sums = vec![vec![0.0; n]; 5];
    for (i, c) in problem.contacts.iter().enumerate() {
        for (j, direction) in [(2 * i, c.normal), (2 * i + 1, left(c.normal))] {
            let column = scaled.column(direction, c.arm);
            (0..3).for_each(|axis| sums[axis][j] = column[axis]);
            sums[3][j] = -scaled.yielding(c, direction);
        }
        sums[4][2 * i] = 1.0;
        for sign in [1.0, -1.0] {
            let mut edge = vec![0.0; n];
            (edge[2 * i], edge[2 * i + 1]) = (c.mu, sign);
            conic.at_least((edge, 0.0));
        }
        let mut normal = vec![0.0; n];
        normal[2 * i] = 1.0;
        conic.at_least((normal, 0.0));
    }
    (0..3).for_each(|axis| sums[axis][wrench + axis] = -1.0);
    sums[3][wrench + 3] = 1.0;
    let normals = sums.pop().expect("five sums");
    let push = sums.pop().expect("four sums");
    sums.into_iter().for_each(|row| conic.equal((row, 0.0)));
    // the part of the push that is positive: a drive that is dragged along need not yield
    conic.at_least((push, 0.0));
    let mut positive = vec![0.0; n];
    positive[wrench + 3] = 1.0;
    conic.at_least((positive, 0.0));
    conic.equal((normals, -1.0));
    // every attempt's impulses are within the cones: the least of their wrenches is nearest to the
    // optimum, where Clarabel stalled in some
    conic
        .attempts()
        .map(|optimum| {
            let wrench = &optimum.x[wrench..];
            wrench.iter().fold(0.0f64, |size, x| size.max(x.abs()))
        })
        .reduce(f64::min)
        .expect("a bounded quadratic program")
}
