//! The linear system of one Newton step on an [`Ncp`], with all impulses eliminated:
//! [`Linearised`].
//!
//! Every impulse is a linear function of the twist and of the pusher's yield y; what is left is a
//! 3×3 system in the twist, whatever the number of contacts, and one equation in y.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::rows::{ContactRow, FootRow, Ncp, ROOM, Triple, dot};
use crate::ncp::unknowns::Impulses;
use crate::solver::elimination::{solve_four, solve_three};

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

impl<const W: usize> FootStep<W> {
    /// Moves the impulse `p` of `foot` by its step under a change `dv` of the twist.
    #[inline(always)]
    fn take(&self, foot: &FootRow<W>, dv: &Triple<W>, open: Mask<W>, p: &mut [Lanes<W>; 2]) {
        let ds = foot.slip(dv);
        for (p, (r, k)) in p.iter_mut().zip(self.r.iter().zip(&self.k)) {
            *p = open.select((*p + *r).sub_mul(k[0], ds[0]).sub_mul(k[1], ds[1]), *p);
        }
    }
}

/// The stall pair, linearised: slack·d(F_stall − F) + pusher·dy = rhs, both coefficients at least
/// 0.
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
    /// The pusher yields and the object resists with the stall force where `yields`, else it keeps
    /// its commanded motion.
    #[inline(always)]
    pub fn decided(yields: Mask<W>, slack: Lanes<W>, pusher_yield: Lanes<W>) -> Self {
        let one = Lanes::splat(1.0);
        Self {
            slack: yields.zero_unless(one),
            pusher: (!yields).zero_unless(one),
            rhs: -yields.select(slack, pusher_yield),
        }
    }

    /// Whether y is 0 and stays so in every lane.
    #[inline(always)]
    fn holds_all(&self, pusher_yield: Lanes<W>) -> bool {
        !(self.slack.abs() + pusher_yield.abs() + self.rhs.abs())
            .gt(Lanes::ZERO)
            .any()
    }
}

/// All rows of a problem, linearised at a guess.
#[derive(Clone, Debug)]
pub struct Linearised<const W: usize> {
    /// Velocity that follows from the guess's impulses, less the guess's own.
    pub imbalance: Triple<W>,
    /// Those contacts, by number, that carry an impulse or may come to: the others keep none.
    pub contacts: Vec<(usize, ContactStep<W>)>,
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
            feet: [FootStep {
                r: [o; 2],
                k: [[o; 2]; 2],
            }; 3],
            stall: StallStep {
                slack: o,
                pusher: Lanes::splat(1.0),
                rhs: o,
            },
        }
    }
}

impl<const W: usize> Linearised<W> {
    /// Moves `p` by the full Newton step in the lanes of `open`, however badly conditioned.
    #[inline(always)]
    pub fn step(&self, ncp: &Ncp<W>, p: &mut Impulses<W>, open: Mask<W>) {
        let momentum = self.momentum(ncp);
        let [x, y, turn, dy] = if self.stall.holds_all(p.pusher_yield) {
            let [x, y, turn] = solve_three(&momentum.equations());
            [x, y, turn, Lanes::ZERO]
        } else {
            solve_four(
                &self
                    .push(ncp)
                    .bordered(&self.stall, &momentum, p.pusher_yield),
            )
        };
        self.take_step([x, y, turn], dy, ncp, p, open);
    }

    /// The twist is updated rather than summed from the impulses, which would round at the size of
    /// the impulses.
    #[inline(always)]
    fn take_step(
        &self,
        dv: Triple<W>,
        dy: Lanes<W>,
        ncp: &Ncp<W>,
        p: &mut Impulses<W>,
        open: Mask<W>,
    ) {
        // no loop: across the feet instead of the lanes, the compiler would gather lane by lane
        let ([a, b, c], [foot_a, foot_b, foot_c]) = (&mut p.feet, &ncp.feet);
        self.feet[0].take(foot_a, &dv, open, a);
        self.feet[1].take(foot_b, &dv, open, b);
        self.feet[2].take(foot_c, &dv, open, c);
        for (i, step) in &self.contacts {
            let (row, p_n, p_t) = (&ncp.contacts[*i], &mut p.normal[*i], &mut p.tangential[*i]);
            let dgamma = dot(&row.n, &dv).add_mul(row.nd, dy);
            let ds = dot(&row.t, &dv).add_mul(row.td, dy);
            *p_n = open.select((*p_n + step.n).sub_mul(step.nn, dgamma), *p_n);
            *p_t = open.select(
                (*p_t + step.t)
                    .sub_mul(step.tt, ds)
                    .sub_mul(step.tn, dgamma),
                *p_t,
            );
        }
        p.pusher_yield = open.select(p.pusher_yield + dy, p.pusher_yield);
        for (v, dv) in p.v.iter_mut().zip(dv) {
            *v = open.select(*v + dv, *v);
        }
    }

    #[inline(always)]
    fn momentum(&self, ncp: &Ncp<W>) -> Momentum<W> {
        let mut system = Momentum::identity(self.imbalance);
        for (foot, step) in ncp.feet.iter().zip(&self.feet) {
            system.add_foot(foot, step);
        }
        for (i, step) in &self.contacts {
            system.add_contact(&ncp.contacts[*i], step);
        }
        system
    }

    #[inline(always)]
    fn push(&self, ncp: &Ncp<W>) -> Push<W> {
        let o = Lanes::ZERO;
        let mut push = Push {
            column: [o; 3],
            row: [o; 3],
            corner: o,
            rhs: o,
        };
        for (i, step) in &self.contacts {
            push.add_contact(&ncp.contacts[*i], step);
        }
        push
    }
}

/// The three momentum balances, condensed: matrix·dv = rhs where the pusher's yield stays.
struct Momentum<const W: usize> {
    matrix: [Triple<W>; 3],
    rhs: Triple<W>,
}

impl<const W: usize> Momentum<W> {
    #[inline(always)]
    fn identity(rhs: Triple<W>) -> Self {
        let mut matrix = [[Lanes::ZERO; 3]; 3];
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] = Lanes::splat(1.0);
        }
        Self { matrix, rhs }
    }

    /// As rows of coefficients and right-hand side.
    #[inline(always)]
    fn equations(&self) -> [[Lanes<W>; 4]; 3] {
        let (a, r) = (&self.matrix, &self.rhs);
        [
            [a[0][0], a[0][1], a[0][2], r[0]],
            [a[1][0], a[1][1], a[1][2], r[1]],
            [a[2][0], a[2][1], a[2][2], r[2]],
        ]
    }

    /// A += Jᵀ K J, rhs += Jᵀ r.
    #[inline(always)]
    fn add_foot(&mut self, foot: &FootRow<W>, step: &FootStep<W>) {
        let row = |k: &[Lanes<W>; 2]| [k[0], k[1], (k[0] * foot.jx).add_mul(k[1], foot.jy)];
        let k = [row(&step.k[0]), row(&step.k[1])];
        for j in 0..3 {
            self.matrix[0][j] += k[0][j];
            self.matrix[1][j] += k[1][j];
            self.matrix[2][j] = self.matrix[2][j]
                .add_mul(foot.jx, k[0][j])
                .add_mul(foot.jy, k[1][j]);
        }
        foot.add_wrench(&mut self.rhs, &step.r);
    }

    /// A += n ⊗ nn n + t ⊗ (tt t + tn n).
    #[inline(always)]
    fn add_contact(&mut self, ContactRow { n, t, .. }: &ContactRow<W>, step: &ContactStep<W>) {
        for j in 0..3 {
            let (normal, tangential) = (step.nn * n[j], (step.tt * t[j]).add_mul(step.tn, n[j]));
            for i in 0..3 {
                self.matrix[i][j] = self.matrix[i][j]
                    .add_mul(n[i], normal)
                    .add_mul(t[i], tangential);
            }
        }
        for i in 0..3 {
            self.rhs[i] = self.rhs[i].add_mul(n[i], step.n).add_mul(t[i], step.t);
        }
    }
}

/// The pusher's force F, by which the object resists along d: dF = rhs − row·dv − corner dy; and
/// what its yield does to the momentum: matrix·dv + column dy = rhs.
struct Push<const W: usize> {
    column: Triple<W>,
    row: Triple<W>,
    corner: Lanes<W>,
    rhs: Lanes<W>,
}

impl<const W: usize> Push<W> {
    /// [`Momentum::add_contact`] with n and t extended by their parts along d.
    #[inline(always)]
    fn add_contact(
        &mut self,
        ContactRow { n, t, nd, td, .. }: &ContactRow<W>,
        step: &ContactStep<W>,
    ) {
        let (normal, tangential) = (step.nn * *nd, (step.tt * *td).add_mul(step.tn, *nd));
        for j in 0..3 {
            self.column[j] = self.column[j]
                .add_mul(n[j], normal)
                .add_mul(t[j], tangential);
            self.row[j] = self.row[j]
                .add_mul(*nd, step.nn * n[j])
                .add_mul(*td, (step.tt * t[j]).add_mul(step.tn, n[j]));
        }
        self.corner = self.corner.add_mul(*nd, normal).add_mul(*td, tangential);
        self.rhs = self.rhs.add_mul(*nd, step.n).add_mul(*td, step.t);
    }

    /// The system in (dv, dy) whose fourth row is the stall pair; `pusher_yield` is the present y.
    #[inline(always)]
    fn bordered(
        &self,
        stall: &StallStep<W>,
        momentum: &Momentum<W>,
        pusher_yield: Lanes<W>,
    ) -> [[Lanes<W>; 5]; 4] {
        let determined =
            ((stall.slack * self.corner).abs() + stall.pusher).gt(Lanes::splat(UNDETERMINED));
        let last = |number: Lanes<W>| determined.zero_unless(stall.slack * number);
        let corner = last(self.corner) + determined.select(stall.pusher, Lanes::splat(1.0));
        let stalled = determined.select(stall.rhs + stall.slack * self.rhs, -pusher_yield);
        let [a, b, c] = &momentum.equations();
        [
            [a[0], a[1], a[2], self.column[0], a[3]],
            [b[0], b[1], b[2], self.column[1], b[3]],
            [c[0], c[1], c[2], self.column[2], c[3]],
            [
                last(self.row[0]),
                last(self.row[1]),
                last(self.row[2]),
                corner,
                stalled,
            ],
        ]
    }
}
