//! The fast solver: a semismooth Newton iteration on the natural map of the mixed NCP, `W` particles side by side.
//!
//! Every row is either held (its velocity is driven to zero) or given (its impulse is known up to the other rows), decided by
//! the natural map of the iterate as in Alart & Curnier (1991). Held rows enter with a finite stiffness k and keep their impulse
//! from one iteration to the next (a method of multipliers), so that redundant contacts do no harm. The error shrinks by about
//! 1/k an iteration once the modes are right; a particle's warm start is its last step's impulses.

use crate::condensed::{ContactStep, FootStep, Linearised, StallStep};
use crate::impulses::Impulses;
use crate::lanes::{Lanes, Mask};
use crate::ncp::{ContactRow, FootRow, Ncp, Triple, dot};

/// Stiffness k of held rows, in units of the object's mass per step.
pub const STIFFNESS: f64 = 1.0e6;

/// Iterates from `p` (velocity and impulses) until every lane's residual is at most `tolerance`, or `limit` iterations.
///
/// Lanes that are done keep their result while others go on, so a lane's bits do not depend on its neighbours.
/// Returns the residual and the iterations of each lane.
#[inline(always)]
pub fn newton<const W: usize>(
    ncp: &Ncp<W>,
    p: &mut Impulses<W>,
    work: &mut Linearised<W>,
    tolerance: f64,
    limit: u32,
) -> (Lanes<W>, Lanes<W>) {
    let mut residual = ncp.residual(p);
    let mut iterations = Lanes::ZERO;
    for _ in 0..limit {
        let open = residual.gt(Lanes::splat(tolerance));
        if !open.any() {
            break;
        }
        work.by_natural_map(ncp, p);
        work.step(ncp, p, open);
        residual = open.select(ncp.residual(p), residual);
        iterations += open.keep(Lanes::splat(1.0));
    }
    (residual, iterations)
}

impl<const W: usize> Linearised<W> {
    /// The natural map's own choice of modes at `p`.
    #[inline(always)]
    fn by_natural_map(&mut self, ncp: &Ncp<W>, p: &Impulses<W>) {
        for (step, (foot, p_k)) in self.feet.iter_mut().zip(ncp.feet.iter().zip(&p.feet)) {
            *step = linearise_foot(foot, p_k, &p.v);
        }
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gamma = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
            let slip = row.slip_velocity(&p.v, p.pusher_yield);
            self.contacts.push(linearise_contact(row, [*p_n, *p_t], gamma, slip, ncp.compliance));
        }
        let slack = ncp.stall - ncp.resistance(p);
        self.stall = StallStep::decided(p.pusher_yield.gt(slack), slack, p.pusher_yield);
    }
}

/// Natural map of a foot: stuck where |p − s| ≤ bound, else sliding with p on the rim.
#[inline(always)]
fn linearise_foot<const W: usize>(foot: &FootRow<W>, p: &[Lanes<W>; 2], v: &Triple<W>) -> FootStep<W> {
    let one = Lanes::splat(1.0);
    let s = foot.slip(v);
    let z = [p[0] - s[0], p[1] - s[1]];
    let length = (z[0] * z[0] + z[1] * z[1]).sqrt();
    let sliding = length.gt(foot.bound);
    let inverse = one / sliding.select(length, one);
    let dir = [z[0] * inverse, z[1] * inverse];

    // sliding: along dir the impulse is the bound, across it turns with stiffness bound / (|z| − bound)
    let excess = (length - foot.bound).max(foot.bound * (1.0 / STIFFNESS)).max(Lanes::splat(1e-300));
    let across = foot.bound / excess;
    let miss = [foot.bound * dir[0] - p[0], foot.bound * dir[1] - p[1]];
    let miss_along = miss[0] * dir[0] + miss[1] * dir[1];
    let miss_across = (miss[1] * dir[0] - miss[0] * dir[1]) * (across + one);
    let slide = [miss_along * dir[0] - miss_across * dir[1], miss_along * dir[1] + miss_across * dir[0]];

    // stuck: s is driven to zero
    let k = Lanes::splat(STIFFNESS);
    let cross = sliding.select(-across * dir[0] * dir[1], Lanes::ZERO);
    FootStep {
        r: [sliding.select(slide[0], -s[0] * k), sliding.select(slide[1], -s[1] * k)],
        k: [[sliding.select(across * dir[1] * dir[1], k), cross], [cross, sliding.select(across * dir[0] * dir[0], k)]],
    }
}

/// Natural map of a contact: open, sticking or sliding either way.
#[inline(always)]
fn linearise_contact<const W: usize>(
    row: &ContactRow<W>,
    p: [Lanes<W>; 2],
    gamma: Lanes<W>,
    slip: Lanes<W>,
    compliance: Lanes<W>,
) -> ContactStep<W> {
    let one = Lanes::splat(1.0);
    let closed = p[0].gt(gamma / dot(&row.n, &row.n).max(one));
    let z = p[1] - slip / dot(&row.t, &row.t).max(one);
    let sliding = z.abs().gt(row.mu * p[0].max(Lanes::ZERO));
    ContactStep::in_mode(p, [gamma, slip], Mode { closed, sliding, ratio: z.sign() * row.mu }, compliance)
}

/// What a contact does.
#[derive(Clone, Copy, Debug)]
pub struct Mode<const W: usize> {
    /// Its gap is held at zero.
    pub closed: Mask<W>,
    /// p_t = ratio p_n; else its slip is held at zero, where it is closed.
    pub sliding: Mask<W>,
    /// ±μ.
    pub ratio: Lanes<W>,
}

impl<const W: usize> ContactStep<W> {
    /// A contact of impulses `p` and velocities (γ, s) in a given mode.
    #[inline(always)]
    pub fn in_mode(p: [Lanes<W>; 2], [gamma, slip]: [Lanes<W>; 2], mode: Mode<W>, compliance: Lanes<W>) -> Self {
        let one = Lanes::splat(1.0);
        let stick = Lanes::splat(STIFFNESS);
        let k = one / (Lanes::splat(1.0 / STIFFNESS) + compliance);
        let n = mode.closed.select(-gamma * k, -p[0]);
        let nn = mode.closed.keep(k);
        let free = mode.sliding | !mode.closed;
        Self {
            n,
            t: free.select(mode.ratio * (p[0] + n) - p[1], -slip * stick),
            nn,
            tn: free.keep(mode.ratio * nn),
            tt: free.select(Lanes::ZERO, stick),
        }
    }
}
