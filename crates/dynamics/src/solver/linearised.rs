//! The linear system of one Newton step on an [`Ncp`], with all impulses eliminated:
//! [`Linearised`].
//!
//! Every impulse is a linear function of the twist and of the pusher's yield y. Eliminating them
//! leaves a 3×3 system in the twist, whatever the number of contacts, and one equation in y.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::rows::{ContactRow, FootRow, Ncp, ROOM, Triple, dot};
use crate::ncp::unknowns::Unknowns;
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
#[derive(Clone, Copy, Debug, Default)]
pub struct FootStep<const W: usize> {
    /// dp at ds = 0.
    pub r: [Lanes<W>; 2],
    /// −∂p/∂s.
    pub k: [[Lanes<W>; 2]; 2],
}

impl<const W: usize> FootStep<W> {
    /// Moves the impulse `p` of `foot` by its step under a change `dv` of the twist.
    #[inline(always)]
    fn apply(&self, foot: &FootRow<W>, dv: &Triple<W>, lanes: Mask<W>, p: &mut [Lanes<W>; 2]) {
        let ds = foot.slip(dv);
        for (p, (r, k)) in p.iter_mut().zip(self.r.iter().zip(&self.k)) {
            *p = lanes.select((*p + *r).sub_mul(k[0], ds[0]).sub_mul(k[1], ds[1]), *p);
        }
    }
}

/// Linear model of the stall pair: slack·d(F_stall − F) + pusher·dy = rhs, both coefficients at
/// least 0.
#[derive(Clone, Copy, Debug)]
pub struct StallStep<const W: usize> {
    /// Coefficient of the slack.
    pub slack: Lanes<W>,
    /// Coefficient of y.
    pub pusher: Lanes<W>,
    /// Right-hand side.
    pub rhs: Lanes<W>,
}

/// Coefficient of y below which no equation determines y: it is then set to 0.
const UNDETERMINED: f64 = 1e-9;

impl<const W: usize> StallStep<W> {
    /// In lanes of `yields` the object resists with the stall force; elsewhere the pusher keeps its
    /// commanded motion.
    #[inline(always)]
    pub fn in_mode(yields: Mask<W>, slack: Lanes<W>, pusher_yield: Lanes<W>) -> Self {
        let one = Lanes::splat(1.0);
        Self {
            slack: yields.zero_unless(one),
            pusher: (!yields).zero_unless(one),
            rhs: -yields.select(slack, pusher_yield),
        }
    }

    /// Returns true if y is 0 and stays so in every lane.
    #[inline(always)]
    fn keeps_zero(&self, pusher_yield: Lanes<W>) -> bool {
        !(self.slack.abs() + pusher_yield.abs() + self.rhs.abs())
            .gt(Lanes::ZERO)
            .any()
    }
}

/// All rows of a problem, linearised at one point.
#[derive(Clone, Debug)]
pub struct Linearised<const W: usize> {
    /// Velocity that follows from the point's impulses, less the point's own.
    pub imbalance: Triple<W>,
    /// The contacts, by number, that carry an impulse or may get one; the others keep none.
    pub contacts: Vec<(usize, ContactStep<W>)>,
    /// One per foot.
    pub feet: [FootStep<W>; 3],
    /// The stall pair.
    pub stall: StallStep<W>,
}

impl<const W: usize> Default for Linearised<W> {
    fn default() -> Self {
        Self {
            imbalance: [Lanes::ZERO; 3],
            contacts: Vec::with_capacity(ROOM),
            feet: [FootStep::default(); 3],
            stall: StallStep {
                slack: Lanes::ZERO,
                pusher: Lanes::splat(1.0),
                rhs: Lanes::ZERO,
            },
        }
    }
}

impl<const W: usize> Linearised<W> {
    /// Moves `z` by the full Newton step in the given lanes, however badly conditioned.
    #[inline(always)]
    pub fn step(&self, ncp: &Ncp<W>, z: &mut Unknowns<W>, lanes: Mask<W>) {
        let momentum = self.momentum(ncp);
        let [x, y, turn, dy] = if self.stall.keeps_zero(z.pusher_yield) {
            let [x, y, turn] = solve_three(&momentum.equations());
            [x, y, turn, Lanes::ZERO]
        } else {
            let border = self.border(ncp);
            solve_four(&border.equations(&self.stall, &momentum, z.pusher_yield))
        };
        self.apply([x, y, turn], dy, ncp, z, lanes);
    }

    /// Moves all unknowns by their steps under the changes dv and dy.
    ///
    /// The twist is updated rather than summed from the impulses, which would round at the size of
    /// the impulses.
    #[inline(always)]
    fn apply(
        &self,
        dv: Triple<W>,
        dy: Lanes<W>,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        lanes: Mask<W>,
    ) {
        // no loop: the compiler would vectorise across the feet instead of the lanes, with gathers
        let ([a, b, c], [foot_a, foot_b, foot_c]) = (&mut z.feet, &ncp.feet);
        self.feet[0].apply(foot_a, &dv, lanes, a);
        self.feet[1].apply(foot_b, &dv, lanes, b);
        self.feet[2].apply(foot_c, &dv, lanes, c);
        for (i, step) in &self.contacts {
            let (row, p_n, p_t) = (&ncp.contacts[*i], &mut z.normal[*i], &mut z.tangential[*i]);
            let dgamma = dot(&row.n, &dv).add_mul(row.nd, dy);
            let ds = dot(&row.t, &dv).add_mul(row.td, dy);
            *p_n = lanes.select((*p_n + step.n).sub_mul(step.nn, dgamma), *p_n);
            *p_t = lanes.select(
                (*p_t + step.t)
                    .sub_mul(step.tt, ds)
                    .sub_mul(step.tn, dgamma),
                *p_t,
            );
        }
        z.pusher_yield = lanes.select(z.pusher_yield + dy, z.pusher_yield);
        for (v, dv) in z.v.iter_mut().zip(dv) {
            *v = lanes.select(*v + dv, *v);
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
    fn border(&self, ncp: &Ncp<W>) -> Border<W> {
        let mut border = Border::ZERO;
        for (i, step) in &self.contacts {
            border.add_contact(&ncp.contacts[*i], step);
        }
        border
    }
}

/// The three momentum balances with the impulses eliminated: matrix·dv = rhs at dy = 0.
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

    /// Each row's coefficients, then its right-hand side.
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

/// Terms that y adds to the system: matrix·dv + column dy = momentum's rhs. The impulse F with
/// which the object resists the pusher changes by dF = rhs − row·dv − corner dy.
struct Border<const W: usize> {
    column: Triple<W>,
    row: Triple<W>,
    corner: Lanes<W>,
    rhs: Lanes<W>,
}

impl<const W: usize> Border<W> {
    /// Of no contact.
    const ZERO: Self = Self {
        column: [Lanes::ZERO; 3],
        row: [Lanes::ZERO; 3],
        corner: Lanes::ZERO,
        rhs: Lanes::ZERO,
    };

    /// [`Momentum::add_contact`], with nd and td as the fourth components of n and t.
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
    fn equations(
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
