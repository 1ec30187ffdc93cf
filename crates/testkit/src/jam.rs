//! Conditions under which a step can fail to have a solution: [`gap_margin`], [`may_jam`] and
//! [`is_solvable`].
//!
//! The answers are one-sided. Below zero margin the gap rows exclude each other, at any speed that
//! is sought: no solution. Where the friction cones admit no impulses that cancel each other (their
//! sum is a pointed cone) there is always a solution: impulses p that grow without bound along a
//! homotopy would have W p/|p| tend to zero. In between, jamming by friction, both are silent.
//!
//! Faces that close on an object at a slight angle meet both conditions. Their solution squeezes it
//! out at an absurd speed, and none is sought there. So a step *must* be solved only where its
//! solutions are slow enough, too: [`is_solvable`].

use stickslip_dynamics::StepProblem;

use crate::conic_program::ConicProgram;
use crate::hull::nearest_in_hull;
use crate::scaled_problem::{ScaledProblem, dot3};
use crate::speed_limit::{LARGEST_IMPULSE, speed_limit};
use crate::vector::left;

/// Wrenches of unit impulses that sum to less than this may cancel each other.
const CANCELLED: f64 = 1e-5;

/// Speed at which all gaps can open at once (m/s), at most `cap`, at speeds up to [`speed_limit`].
///
/// It is negative where the gap rows exclude each other: then there is no solution of such a speed,
/// whatever the friction.
///
/// # Panics
/// Where Clarabel fails on this bounded linear program.
#[must_use]
pub fn gap_margin(problem: &StepProblem, cap: f64) -> f64 {
    let scaled = ScaledProblem::new(problem);
    let (cap, fastest) = (cap / scaled.speed(), speed_limit(problem) / scaled.speed());
    // unknowns: z, y and the margin
    let mut conic = ConicProgram::new(5);
    conic.cost[4] = -1.0;
    for contact in &problem.contacts {
        let [x, y, turn] = scaled.normal(contact);
        // gaps wider than any twist can close never bind; large numbers would cost accuracy
        let offset = scaled.gap_offset(contact).min(cap + 10.0 * fastest);
        conic.at_least((
            vec![x, y, turn, scaled.yielding(contact, contact.normal), -1.0],
            offset,
        ));
    }
    let limits = if problem.stall.is_some() {
        [fastest; 4]
    } else {
        [fastest, fastest, fastest, 0.0]
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

/// Returns true if impulses within the friction cones can cancel each other while a drive with a
/// force limit does not push.
///
/// Where they cannot, a solution exists, though perhaps none as slow as is sought: [`is_solvable`].
/// Impulses that cancel to 1e-5 of their size count as cancelling, open contacts as closed.
#[must_use]
pub fn may_jam(problem: &StepProblem) -> bool {
    !problem.contacts.is_empty() && least_wrench(problem) < CANCELLED
}

/// Returns true if a step certainly has a solution that is sought: impulses cannot cancel each
/// other, and those that a solution needs give it no speed above [`speed_limit`].
///
/// Let the wrenches of impulses P in all, with the positive part of the push, be at least δ P.
/// Balance bounds P: δ P ≤ |v| + |free| + F + Q, with F the resistance of the feet and Q the
/// drive's impulse.
///
/// Work bounds |v|. The feet and the slips take power, and the drive takes y Q. A closed gap gives
/// p_n times its offset and a slip p_t times its own. So |v|² + y Q ≤ |v| |free| + P g, with g the
/// largest such offset. All is in mass-normalised units.
#[must_use]
pub fn is_solvable(problem: &StepProblem) -> bool {
    if problem.contacts.is_empty() {
        return true;
    }
    let least = least_wrench(problem);
    if least < CANCELLED {
        return false;
    }
    let scaled = ScaledProblem::new(problem);
    let free = libm::sqrt(dot3(&scaled.free(), &scaled.free()));
    let offset = |c| (-scaled.gap_offset(c)).max(0.0) + c.mu * scaled.slip_offset(c).abs();
    let gain = problem.contacts.iter().map(offset).fold(0.0, f64::max);
    let resists = |k: usize| {
        let [x, y] = scaled.foot(k).map(|row| dot3(&row, &row));
        scaled.bound(k) * libm::sqrt(x + y - 1.0)
    };
    let feet: f64 = (0..3).map(resists).sum();
    let drive = scaled.stall_impulse();
    // |v|² ≤ |v| (free + g/δ) + (free + F + Q) g/δ
    let half = 0.5 * (free + gain / least);
    let rest = free + feet + drive.unwrap_or(0.0);
    let speed = half + libm::sqrt(half * half + rest * gain / least);
    let impulses = (speed + rest) / least;
    let pusher_yield = drive.map_or(0.0, |drive| (impulses * gain + 0.25 * free * free) / drive);
    speed.max(pusher_yield) * scaled.speed() <= speed_limit(problem)
        && impulses * scaled.speed() <= LARGEST_IMPULSE
}

/// Least size of the sum of wrenches, with the push along the drive, for impulses whose normal
/// parts sum to one.
fn least_wrench(problem: &StepProblem) -> f64 {
    let scaled = ScaledProblem::new(problem);
    // the edges of the friction cones: wrench, then push
    let mut edges = Vec::new();
    for c in &problem.contacts {
        for sign in [1.0, -1.0] {
            let (n, t) = (c.normal, left(c.normal));
            let edge = [0, 1].map(|k| n[k] + sign * c.mu * t[k]);
            let [x, y, turn] = scaled.column(edge, c.arm);
            edges.push([x, y, turn, scaled.yielding(c, edge)]);
        }
    }
    // only the part of the push that is positive: a drive that is dragged along need not yield
    let mut nearest = nearest_in_hull(&edges, &[[0.0, 0.0, 0.0, 1.0]]);
    nearest[3] = nearest[3].max(0.0);
    // what all edges have along it bounds the sum, however near the nearest point is known
    let size = nearest.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size == 0.0 {
        return 0.0;
    }
    let along = |edge: &[f64; 4]| edge.iter().zip(&nearest).map(|(a, b)| a * b / size).sum();
    edges.iter().map(along).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::ContactPoint;

    use super::*;

    /// A pusher that has the object between two of its faces, ±n at arms ±(0.3, `apart`).
    fn pinched(apart: f64) -> StepProblem {
        let contact = |sign: f64| ContactPoint {
            normal: [-sign, 0.0],
            arm: [0.3 * sign, apart * sign],
            mu: 0.5,
            yields: Some([1.0, 0.0]),
            gap: 0.0,
            surface_velocity: [0.0; 2],
        };
        StepProblem {
            mass: 1.0,
            inertia: 1.0,
            h: 1.0,
            contacts: vec![contact(1.0), contact(-1.0)],
            stall: Some(0.02),
            ..StepProblem::default()
        }
    }

    #[test]
    fn two_faces_jam_where_the_line_between_their_contacts_is_within_both_cones() {
        assert!(least_wrench(&pinched(0.1)) < 1e-15, "self-locking");
        assert!(may_jam(&pinched(0.149)), "just so");
        assert!(!may_jam(&pinched(0.151)), "just not");
    }

    #[test]
    fn object_between_pusher_and_fixel_jams_where_the_drive_does_not_give_way() {
        let mut problem = pinched(0.0);
        problem.contacts[0].yields = None;
        // the pusher at the left presses along +x, and so resists its drive
        assert!(!may_jam(&problem), "the drive gives way");
        problem.contacts[1].yields = Some([-1.0, 0.0]);
        assert!(may_jam(&problem), "what drags it along need not yield");
        problem.stall = None;
        assert!(may_jam(&problem), "rigid");
    }
}
