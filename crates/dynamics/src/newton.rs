//! The fast solver: a semismooth Newton iteration on the natural map of the mixed NCP, `W` particles side by side.
//!
//! Every row is either held (its velocity is driven to zero) or given (its impulse is known up to the other rows), decided by
//! the natural map of the iterate as in Alart & Curnier (1991). Held rows enter with a finite stiffness k and keep their impulse
//! from one iteration to the next (a method of multipliers), so that redundant contacts do no harm and eliminating all impulses
//! leaves a 3×3 system in the twist whatever the number of contacts. The error shrinks by about 1/k an iteration once the
//! modes are right; a particle's warm start is its last step's impulses.

use crate::lanes::{Lanes, Mask};
use crate::ncp::{ContactRow, FootRow, Impulses, Ncp, Triple, add_scaled, dot};

/// Stiffness k of held rows, in units of the object's mass per step.
const STIFFNESS: f64 = 1.0e6;

/// Linear model of one contact's impulse increments:
/// dp_n = a − kn (n·dv + nd dy), dp_t = b − kt (t·dv + td dy) − kc (n·dv + nd dy).
#[derive(Clone, Copy, Debug)]
struct ContactStep<const W: usize> {
    a: Lanes<W>,
    b: Lanes<W>,
    kn: Lanes<W>,
    kt: Lanes<W>,
    kc: Lanes<W>,
}

/// Linear model of one foot's impulse increment: dp = r − K J dv with K symmetric.
#[derive(Clone, Copy, Debug)]
struct FootStep<const W: usize> {
    r: [Lanes<W>; 2],
    kxx: Lanes<W>,
    kxy: Lanes<W>,
    kyy: Lanes<W>,
}

/// The condensed system A dv + column dy = rhs, −row·dv − corner dy = yield_rhs.
struct Condensed<const W: usize> {
    matrix: [Triple<W>; 3],
    rhs: Triple<W>,
    column: Triple<W>,
    row: Triple<W>,
    corner: Lanes<W>,
    given: Lanes<W>,
}

/// Working memory of the Newton iteration.
#[derive(Clone, Debug, Default)]
pub struct NewtonWorkspace<const W: usize> {
    steps: Vec<ContactStep<W>>,
}

/// Iterates from `p` (velocity and impulses) until every lane's residual is at most `tolerance`, or `limit` iterations.
///
/// Lanes that are done keep their result while others go on, so a lane's bits do not depend on its neighbours.
/// Returns the residual and the iterations of each lane.
#[inline(always)]
pub fn newton<const W: usize>(
    ncp: &Ncp<W>,
    p: &mut Impulses<W>,
    work: &mut NewtonWorkspace<W>,
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
        iterate(ncp, p, work, open);
        residual = open.select(ncp.residual(p), residual);
        iterations += open.select(Lanes::splat(1.0), Lanes::ZERO);
    }
    (residual, iterations)
}

/// One Newton step in the lanes of `open`.
#[inline(always)]
fn iterate<const W: usize>(ncp: &Ncp<W>, p: &mut Impulses<W>, work: &mut NewtonWorkspace<W>, open: Mask<W>) {
    let mut system = Condensed::identity();
    system.rhs = ncp.velocity(p);
    add_scaled(&mut system.rhs, &p.v, Lanes::splat(-1.0));

    // linearise feet and contacts and eliminate their impulses
    let feet = [0, 1, 2].map(|k| {
        let step = linearise_foot(&ncp.feet[k], &p.feet[k], &p.v);
        system.add_foot(&ncp.feet[k], &step);
        step
    });
    work.steps.clear();
    for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
        let gamma = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
        let slip = row.slip_velocity(&p.v, p.pusher_yield);
        let step = linearise_contact(row, [*p_n, *p_t], gamma, slip, ncp.compliance);
        system.add_contact(row, &step);
        work.steps.push(step);
    }
    let (dv, dy) = system.solve(ncp.stall - ncp.resistance(p), p.pusher_yield);

    // recover the impulses; the twist is updated rather than summed from them, which would round at the size of the impulses
    for ((foot, step), p_k) in ncp.feet.iter().zip(&feet).zip(&mut p.feet) {
        let ds = foot.slip(&dv);
        let dp = [step.r[0] - step.kxx * ds[0] - step.kxy * ds[1], step.r[1] - step.kxy * ds[0] - step.kyy * ds[1]];
        *p_k = [open.select(p_k[0] + dp[0], p_k[0]), open.select(p_k[1] + dp[1], p_k[1])];
    }
    for (i, (row, step)) in ncp.contacts.iter().zip(&work.steps).enumerate() {
        let dgamma = dot(&row.n, &dv) + row.nd * dy;
        let ds = dot(&row.t, &dv) + row.td * dy;
        p.normal[i] = open.select(p.normal[i] + step.a - step.kn * dgamma, p.normal[i]);
        p.tangential[i] = open.select(p.tangential[i] + step.b - step.kt * ds - step.kc * dgamma, p.tangential[i]);
    }
    p.pusher_yield = open.select(p.pusher_yield + dy, p.pusher_yield);
    for (v, dv) in p.v.iter_mut().zip(dv) {
        *v = open.select(*v + dv, *v);
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
    let slide_r = [miss_along * dir[0] - miss_across * dir[1], miss_along * dir[1] + miss_across * dir[0]];

    // stuck: s is driven to zero
    let k = Lanes::splat(STIFFNESS);
    FootStep {
        r: [sliding.select(slide_r[0], -s[0] * k), sliding.select(slide_r[1], -s[1] * k)],
        kxx: sliding.select(across * dir[1] * dir[1], k),
        kxy: sliding.select(-across * dir[0] * dir[1], Lanes::ZERO),
        kyy: sliding.select(across * dir[0] * dir[0], k),
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
    let k = one / (Lanes::splat(1.0 / STIFFNESS) + compliance);
    let closed = p[0].gt(gamma / dot(&row.n, &row.n).max(one));
    let z = p[1] - slip / dot(&row.t, &row.t).max(one);
    let bound = row.mu * p[0].max(Lanes::ZERO);
    let sliding = z.abs().gt(bound);
    let ratio = z.sign() * row.mu;

    let a = closed.select(-gamma * k, -p[0]);
    let kn = closed.select(k, Lanes::ZERO);
    let sliding_or_open = Mask(std::array::from_fn(|i| sliding.0[i] || !closed.0[i]));
    let stick = Lanes::splat(STIFFNESS);
    ContactStep {
        a,
        b: sliding_or_open.select(ratio * (p[0] + a) - p[1], -slip * stick),
        kn,
        kt: sliding_or_open.select(Lanes::ZERO, stick),
        kc: sliding_or_open.select(ratio * kn, Lanes::ZERO),
    }
}

impl<const W: usize> Condensed<W> {
    #[inline(always)]
    fn identity() -> Self {
        let (o, l) = (Lanes::ZERO, Lanes::splat(1.0));
        Self { matrix: [[l, o, o], [o, l, o], [o, o, l]], rhs: [o; 3], column: [o; 3], row: [o; 3], corner: o, given: o }
    }

    /// A += Jᵀ K J, rhs += Jᵀ r.
    #[inline(always)]
    fn add_foot(&mut self, foot: &FootRow<W>, step: &FootStep<W>) {
        let kx = [step.kxx, step.kxy, step.kxx * foot.jx + step.kxy * foot.jy];
        let ky = [step.kxy, step.kyy, step.kxy * foot.jx + step.kyy * foot.jy];
        let one = Lanes::splat(1.0);
        add_scaled(&mut self.matrix[0], &kx, one);
        add_scaled(&mut self.matrix[1], &ky, one);
        add_scaled(&mut self.matrix[2], &kx, foot.jx);
        add_scaled(&mut self.matrix[2], &ky, foot.jy);
        add_scaled(&mut self.rhs, &foot.wrench(&step.r), one);
    }

    /// A += n ⊗ kn n + t ⊗ (kt t + kc n), and the border of the yielding pusher.
    #[inline(always)]
    fn add_contact(&mut self, row: &ContactRow<W>, step: &ContactStep<W>) {
        let mut tangential = [Lanes::ZERO; 3];
        add_scaled(&mut tangential, &row.t, step.kt);
        add_scaled(&mut tangential, &row.n, step.kc);
        for i in 0..3 {
            add_scaled(&mut self.matrix[i], &row.n, row.n[i] * step.kn);
            add_scaled(&mut self.matrix[i], &tangential, row.t[i]);
        }
        add_scaled(&mut self.rhs, &row.n, step.a);
        add_scaled(&mut self.rhs, &row.t, step.b);

        let tangential_d = step.kt * row.td + step.kc * row.nd;
        add_scaled(&mut self.column, &row.n, step.kn * row.nd);
        add_scaled(&mut self.column, &row.t, tangential_d);
        add_scaled(&mut self.row, &row.n, step.kn * row.nd);
        add_scaled(&mut self.row, &tangential, row.td);
        self.corner += row.nd * step.kn * row.nd + row.td * tangential_d;
        self.given += row.nd * step.a + row.td * step.b;
    }

    /// (dv, dy); `slack` is F_stall h / m − F / m, `pusher_yield` the present y.
    #[inline(always)]
    fn solve(&self, slack: Lanes<W>, pusher_yield: Lanes<W>) -> (Triple<W>, Lanes<W>) {
        let factors = Factors::new(&self.matrix);
        let base = factors.solve(&self.rhs);
        let along = factors.solve(&self.column);
        // corner' = corner − row·A⁻¹ column is the pusher's compliance seen from y; 0 where nothing resists it
        let corner = self.corner - dot(&self.row, &along);
        let yielding = pusher_yield.gt(slack) & corner.gt(Lanes::splat(1e-9));
        let wanted = -(slack - self.given + dot(&self.row, &base)) / yielding.select(corner, Lanes::splat(1.0));
        let dy = yielding.select(wanted, -pusher_yield);
        let mut dv = base;
        add_scaled(&mut dv, &along, -dy);
        (dv, dy)
    }
}

/// P A = L U of a 3×3 matrix: elimination with row pivoting, which stays accurate where some directions are held a million
/// times stiffer than others (an inverse by cofactors does not).
struct Factors<const W: usize> {
    rows: [Triple<W>; 3],
    swap_first: [Mask<W>; 2],
    swap_second: Mask<W>,
    lower: [Lanes<W>; 3],
    pivots: Triple<W>,
}

impl<const W: usize> Factors<W> {
    #[inline(always)]
    fn new(matrix: &[Triple<W>; 3]) -> Self {
        let one = Lanes::splat(1.0);
        let mut m = *matrix;
        let first = m[1][0].abs().gt(m[0][0].abs());
        swap_rows(&mut m, 0, 1, first);
        let second = m[2][0].abs().gt(m[0][0].abs());
        swap_rows(&mut m, 0, 2, second);
        let p0 = one / m[0][0];
        let (mut l1, mut l2) = (m[1][0] * p0, m[2][0] * p0);
        for j in 1..3 {
            m[1][j] -= l1 * m[0][j];
            m[2][j] -= l2 * m[0][j];
        }
        let third = m[2][1].abs().gt(m[1][1].abs());
        swap_rows(&mut m, 1, 2, third);
        (l1, l2) = (third.select(l2, l1), third.select(l1, l2));
        let p1 = one / m[1][1];
        let l21 = m[2][1] * p1;
        let p2 = one / (m[2][2] - l21 * m[1][2]);
        Self { rows: m, swap_first: [first, second], swap_second: third, lower: [l1, l2, l21], pivots: [p0, p1, p2] }
    }

    #[inline(always)]
    fn solve(&self, b: &Triple<W>) -> Triple<W> {
        let mut y = *b;
        swap(&mut y, 0, 1, self.swap_first[0]);
        swap(&mut y, 0, 2, self.swap_first[1]);
        swap(&mut y, 1, 2, self.swap_second);
        y[1] -= self.lower[0] * y[0];
        y[2] -= self.lower[1] * y[0] + self.lower[2] * y[1];
        let x2 = y[2] * self.pivots[2];
        let x1 = (y[1] - self.rows[1][2] * x2) * self.pivots[1];
        let x0 = (y[0] - self.rows[0][1] * x1 - self.rows[0][2] * x2) * self.pivots[0];
        [x0, x1, x2]
    }
}

/// Swaps entries i and j where `mask` holds.
#[inline(always)]
fn swap<const W: usize>(x: &mut Triple<W>, i: usize, j: usize, mask: Mask<W>) {
    (x[i], x[j]) = (mask.select(x[j], x[i]), mask.select(x[i], x[j]));
}

/// Swaps rows i and j where `mask` holds.
#[inline(always)]
fn swap_rows<const W: usize>(m: &mut [Triple<W>; 3], i: usize, j: usize, mask: Mask<W>) {
    for c in 0..3 {
        (m[i][c], m[j][c]) = (mask.select(m[j][c], m[i][c]), mask.select(m[i][c], m[j][c]));
    }
}
