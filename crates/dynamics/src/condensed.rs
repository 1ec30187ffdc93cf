//! The linear system of one Newton step on an [`Ncp`], with all impulses eliminated: [`Linearised`].
//!
//! Every impulse is a linear function of the twist and of the pusher's yield y; what is left is a 3×3 system in the twist,
//! whatever the number of contacts, and one equation in y.

use crate::impulses::Impulses;
use crate::lanes::{Lanes, Mask};
use crate::ncp::{ContactRow, FootRow, Ncp, ROOM, Triple, dot};

/// Linear model of one contact: dp_n = n − nn dγ, dp_t = t − tn dγ − tt ds.
#[derive(Clone, Copy, Debug)]
pub struct ContactStep<const W: usize> {
    /// dp_n at dγ = 0.
    pub n: Lanes<W>,
    /// dp_t at dγ = ds = 0.
    pub t: Lanes<W>,
    /// −∂p_n/∂γ.
    pub nn: Lanes<W>,
    /// −∂p_t/∂γ.
    pub tn: Lanes<W>,
    /// −∂p_t/∂s.
    pub tt: Lanes<W>,
}

/// Linear model of one foot: dp = r − K ds.
#[derive(Clone, Copy, Debug)]
pub struct FootStep<const W: usize> {
    /// dp at ds = 0.
    pub r: [Lanes<W>; 2],
    /// −∂p/∂s.
    pub k: [[Lanes<W>; 2]; 2],
}

/// The stall pair, linearised: slack·d(F_stall − F) + pusher·dy = rhs, both coefficients at least 0.
#[derive(Clone, Copy, Debug)]
pub struct StallStep<const W: usize> {
    /// Coefficient of the slack.
    pub slack: Lanes<W>,
    /// Coefficient of y.
    pub pusher: Lanes<W>,
    /// Right-hand side.
    pub rhs: Lanes<W>,
}

/// Weight of y below which nothing determines it: the pusher then holds.
const UNDETERMINED: f64 = 1e-9;

impl<const W: usize> StallStep<W> {
    /// The pusher yields and the object resists with the stall force where `yields`, else it keeps its commanded motion.
    #[inline(always)]
    pub fn decided(yields: Mask<W>, slack: Lanes<W>, pusher_yield: Lanes<W>) -> Self {
        let one = Lanes::splat(1.0);
        Self { slack: yields.keep(one), pusher: (!yields).keep(one), rhs: -yields.select(slack, pusher_yield) }
    }
}

/// All rows of a problem, linearised at a guess.
#[derive(Clone, Debug)]
pub struct Linearised<const W: usize> {
    /// Velocity that follows from the guess's impulses, less the guess's own.
    pub imbalance: Triple<W>,
    /// One per contact.
    pub contacts: Vec<ContactStep<W>>,
    /// One per foot.
    pub feet: [FootStep<W>; 3],
    /// The stall pair.
    pub stall: StallStep<W>,
}

impl<const W: usize> Default for Linearised<W> {
    fn default() -> Self {
        let o = Lanes::ZERO;
        Self {
            imbalance: [o; 3],
            contacts: Vec::with_capacity(ROOM),
            feet: [FootStep { r: [o; 2], k: [[o; 2]; 2] }; 3],
            stall: StallStep { slack: o, pusher: Lanes::splat(1.0), rhs: o },
        }
    }
}

impl<const W: usize> Linearised<W> {
    /// Moves `p` by the full Newton step in the lanes of `open`.
    #[inline(always)]
    pub fn step(&self, ncp: &Ncp<W>, p: &mut Impulses<W>, open: Mask<W>) {
        let change = self.condense::<4>(ncp).solve(&self.stall, p.pusher_yield);
        self.take_step(change, ncp, p, open);
    }

    /// The same to the bit, sooner where no lane's pusher yields.
    #[inline(always)]
    pub fn step_mostly_commanded(&self, ncp: &Ncp<W>, p: &mut Impulses<W>, open: Mask<W>) {
        if self.stall.slack.gt(Lanes::ZERO).any() {
            return self.step(ncp, p, open);
        }
        let change = self.condense::<3>(ncp).solve(&self.stall, p.pusher_yield);
        self.take_step(change, ncp, p, open);
    }

    /// The twist is updated rather than summed from the impulses, which would round at the size of the impulses.
    #[inline(always)]
    fn take_step(&self, (dv, dy): (Triple<W>, Lanes<W>), ncp: &Ncp<W>, p: &mut Impulses<W>, open: Mask<W>) {
        for ((foot, step), p_k) in ncp.feet.iter().zip(&self.feet).zip(&mut p.feet) {
            let ds = foot.slip(&dv);
            for i in 0..2 {
                p_k[i] = open.select(p_k[i] + step.r[i] - step.k[i][0] * ds[0] - step.k[i][1] * ds[1], p_k[i]);
            }
        }
        let impulses = p.normal.iter_mut().zip(&mut p.tangential);
        for ((row, step), (p_n, p_t)) in ncp.contacts.iter().zip(&self.contacts).zip(impulses) {
            let dgamma = dot(&row.n, &dv) + row.nd * dy;
            let ds = dot(&row.t, &dv) + row.td * dy;
            *p_n = open.select(*p_n + step.n - step.nn * dgamma, *p_n);
            *p_t = open.select(*p_t + step.t - step.tt * ds - step.tn * dgamma, *p_t);
        }
        p.pusher_yield = open.select(p.pusher_yield + dy, p.pusher_yield);
        for (v, dv) in p.v.iter_mut().zip(dv) {
            *v = open.select(*v + dv, *v);
        }
    }

    #[inline(always)]
    fn condense<const N: usize>(&self, ncp: &Ncp<W>) -> Condensed<W, N> {
        let mut system = Condensed::identity();
        system.rhs[..3].copy_from_slice(&self.imbalance);
        for (foot, step) in ncp.feet.iter().zip(&self.feet) {
            system.add_foot(foot, step);
        }
        for (row, step) in ncp.contacts.iter().zip(&self.contacts) {
            system.add_contact(row, step);
        }
        system
    }
}

/// The condensed system in (dv, dy), the first N rows of it: matrix and right-hand side of the three momentum balances, then of the
/// pusher's force, by which the object's resistance F grows.
struct Condensed<const W: usize, const N: usize> {
    matrix: [[Lanes<W>; 4]; N],
    rhs: [Lanes<W>; N],
}

impl<const W: usize, const N: usize> Condensed<W, N> {
    #[inline(always)]
    fn identity() -> Self {
        let mut system = Self { matrix: [[Lanes::ZERO; 4]; N], rhs: [Lanes::ZERO; N] };
        for i in 0..3 {
            system.matrix[i][i] = Lanes::splat(1.0);
        }
        system
    }

    /// A += Jᵀ K J, rhs += Jᵀ r.
    #[inline(always)]
    fn add_foot(&mut self, foot: &FootRow<W>, step: &FootStep<W>) {
        let row = |k: &[Lanes<W>; 2]| [k[0], k[1], k[0] * foot.jx + k[1] * foot.jy];
        let k = [row(&step.k[0]), row(&step.k[1])];
        let r = foot.wrench(&step.r);
        for j in 0..3 {
            self.matrix[0][j] += k[0][j];
            self.matrix[1][j] += k[1][j];
            self.matrix[2][j] += foot.jx * k[0][j] + foot.jy * k[1][j];
            self.rhs[j] += r[j];
        }
    }

    /// A += n ⊗ nn n + t ⊗ (tt t + tn n), with n and t extended by their parts along d.
    #[inline(always)]
    fn add_contact(&mut self, row: &ContactRow<W>, step: &ContactStep<W>) {
        let (n, t) = ([row.n[0], row.n[1], row.n[2], row.nd], [row.t[0], row.t[1], row.t[2], row.td]);
        for j in 0..4 {
            let (normal, tangential) = (step.nn * n[j], step.tt * t[j] + step.tn * n[j]);
            for i in 0..N {
                self.matrix[i][j] += n[i] * normal + t[i] * tangential;
            }
        }
        for i in 0..N {
            self.rhs[i] += n[i] * step.n + t[i] * step.t;
        }
    }

    /// (dv, dy); `pusher_yield` is the present y. The fourth row becomes the stall pair; without one dy is known.
    #[inline(always)]
    fn solve(mut self, stall: &StallStep<W>, pusher_yield: Lanes<W>) -> (Triple<W>, Lanes<W>) {
        if let (Some(row), Some(rhs)) = (self.matrix.get_mut(3), self.rhs.get_mut(3)) {
            let determined = ((stall.slack * row[3]).abs() + stall.pusher).gt(Lanes::splat(UNDETERMINED));
            for number in row.iter_mut() {
                *number = determined.keep(stall.slack * *number);
            }
            row[3] += determined.select(stall.pusher, Lanes::splat(1.0));
            *rhs = determined.select(stall.rhs + stall.slack * *rhs, -pusher_yield);
        }
        let inverse = self.eliminate();
        let mut x = [Lanes::ZERO, Lanes::ZERO, Lanes::ZERO, stall.rhs];
        if N == 4 {
            x[3] = stall.slack.gt(Lanes::ZERO).select(self.rhs[N - 1] * inverse[N - 1], stall.rhs);
        }
        for c in (0..3).rev() {
            x[c] = self.rhs[c];
            for k in c + 1..4 {
                x[c] -= self.matrix[c][k] * x[k];
            }
            x[c] = x[c] * inverse[c];
        }
        let [x, y, turn, dy] = x;
        ([x, y, turn], dy)
    }

    /// Makes the matrix upper triangular; one over its diagonal.
    ///
    /// Gauss elimination with row pivoting stays accurate where some directions are held a million times stiffer than others.
    #[inline(always)]
    fn eliminate(&mut self) -> [Lanes<W>; N] {
        let mut inverse = [Lanes::ZERO; N];
        for c in 0..N {
            for r in c + 1..N {
                let larger = self.matrix[r][c].abs().gt(self.matrix[c][c].abs());
                self.swap_rows(c, r, larger);
            }
            inverse[c] = Lanes::splat(1.0) / self.matrix[c][c];
            for r in c + 1..N {
                let factor = self.matrix[r][c] * inverse[c];
                for k in c + 1..4 {
                    self.matrix[r][k] -= factor * self.matrix[c][k];
                }
                self.rhs[r] -= factor * self.rhs[c];
            }
        }
        inverse
    }

    /// Swaps rows i < j, from column i on, where `mask` holds.
    #[inline(always)]
    fn swap_rows(&mut self, i: usize, j: usize, mask: Mask<W>) {
        let swapped = |a: Lanes<W>, b: Lanes<W>| (mask.select(b, a), mask.select(a, b));
        for k in i..4 {
            (self.matrix[i][k], self.matrix[j][k]) = swapped(self.matrix[i][k], self.matrix[j][k]);
        }
        (self.rhs[i], self.rhs[j]) = swapped(self.rhs[i], self.rhs[j]);
    }
}
