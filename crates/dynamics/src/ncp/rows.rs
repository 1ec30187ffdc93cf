//! The mixed NCP of one step in mass-normalised units, `W` particles side by side: [`Ncp`] and its
//! unknowns [`Impulses`].
//!
//! Impulses are divided by the mass m and rotation is scaled by the radius of gyration ρ, so that
//! every number is a speed (m/s) and the mass matrix is the identity: v = (vx, vy, ρ ω), W_n = (n,
//! r × n / ρ), W_t = (t, r × t / ρ). The residual of [`Ncp::residual`] is the certificate of
//! model.md, "What solved means".

use stickslip_lanes::{Lanes, copy_lane};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::problem::{ContactPoint, StepProblem};
use crate::ncp::unknowns::Impulses;

/// A vector of the scaled velocity space (x, y, ρ θ).
pub type Triple<const W: usize> = [Lanes<W>; 3];

/// a · b.
#[inline(always)]
pub fn dot<const W: usize>(a: &Triple<W>, b: &Triple<W>) -> Lanes<W> {
    (a[0] * b[0]).add_mul(a[1], b[1]).add_mul(a[2], b[2])
}

/// |a|² of a vector of the plane.
#[inline(always)]
pub fn square<const W: usize>([x, y]: &[Lanes<W>; 2]) -> Lanes<W> {
    (*x * *x).add_mul(*y, *y)
}

/// a += b s.
#[inline(always)]
pub fn add_scaled<const W: usize>(a: &mut Triple<W>, b: &Triple<W>, s: Lanes<W>) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = a.add_mul(*b, s);
    }
}

/// One foot: slip velocity s = (v_x + jx v_θ, v_y + jy v_θ), friction bound μ_s p_ns / m.
#[derive(Clone, Copy, Debug)]
pub struct FootRow<const W: usize> {
    /// −r_y / ρ.
    pub jx: Lanes<W>,
    /// r_x / ρ.
    pub jy: Lanes<W>,
    /// Largest friction impulse over m (m/s).
    pub bound: Lanes<W>,
}

/// Gap velocity of rows that only pad (m/s): so large that no smoothing reaches them.
const FAR: f64 = 1e30;

/// One contact: gap velocity γ = n·v + gap + nd y, slip velocity s = t·v + slip + td y.
#[derive(Clone, Copy, Debug)]
pub struct ContactRow<const W: usize> {
    /// Column W_n.
    pub n: Triple<W>,
    /// Column W_t.
    pub t: Triple<W>,
    /// ψ/h − n·u (m/s).
    pub gap: Lanes<W>,
    /// −t·u (m/s).
    pub slip: Lanes<W>,
    /// n·d on the pusher, 0 elsewhere.
    pub nd: Lanes<W>,
    /// t·d on the pusher, 0 elsewhere.
    pub td: Lanes<W>,
    /// Friction coefficient μ.
    pub mu: Lanes<W>,
}

/// Contacts for which working memory has room from the start: a part of it that is first needed
/// late must not make a late step allocate.
pub(crate) const ROOM: usize = 16;

/// `W` mixed NCPs with equally many contact rows (rows that a particle does not need are
/// [`ContactRow::OPEN`]).
#[derive(Clone, Debug)]
pub struct Ncp<const W: usize> {
    /// Velocity without contact and friction impulses: v + M⁻¹ p_app.
    pub free: Triple<W>,
    /// The feet.
    pub feet: [FootRow<W>; 3],
    /// The contacts.
    pub contacts: Vec<ContactRow<W>>,
    /// F_stall h / m (m/s); infinite for a rigid pusher.
    pub stall: Lanes<W>,
    /// Compliance κ of the gap rows: 0, or that of model.md's "Jamming" where no exact solution
    /// exists.
    pub compliance: Lanes<W>,
}

impl<const W: usize> FootRow<W> {
    /// Slip velocity of the foot.
    #[inline(always)]
    pub fn slip(&self, v: &Triple<W>) -> [Lanes<W>; 2] {
        [v[0].add_mul(self.jx, v[2]), v[1].add_mul(self.jy, v[2])]
    }

    /// v += Jᵀ p.
    #[inline(always)]
    pub fn add_wrench(&self, v: &mut Triple<W>, p: &[Lanes<W>; 2]) {
        v[0] += p[0];
        v[1] += p[1];
        v[2] = v[2].add_mul(self.jx, p[0]).add_mul(self.jy, p[1]);
    }
}

impl<const W: usize> ContactRow<W> {
    /// A row that never touches and whose impulses act on nothing.
    pub const OPEN: Self = Self {
        n: [Lanes::ZERO; 3],
        t: [Lanes::ZERO; 3],
        gap: Lanes::splat(FAR),
        slip: Lanes::ZERO,
        nd: Lanes::ZERO,
        td: Lanes::ZERO,
        mu: Lanes::ZERO,
    };

    /// Whether a lane has this contact.
    #[inline(always)]
    pub fn is_present(&self, lane: usize) -> bool {
        self.n[0].0[lane] != 0.0 || self.n[1].0[lane] != 0.0
    }

    #[inline(always)]
    fn numbers(&self) -> [&Lanes<W>; 11] {
        let ([nx, ny, turn], [tx, ty, twist]) = (&self.n, &self.t);
        [
            nx, ny, turn, tx, ty, twist, &self.gap, &self.slip, &self.nd, &self.td, &self.mu,
        ]
    }

    #[inline(always)]
    fn numbers_mut(&mut self) -> [&mut Lanes<W>; 11] {
        let ([nx, ny, turn], [tx, ty, twist]) = (&mut self.n, &mut self.t);
        [
            nx,
            ny,
            turn,
            tx,
            ty,
            twist,
            &mut self.gap,
            &mut self.slip,
            &mut self.nd,
            &mut self.td,
            &mut self.mu,
        ]
    }

    /// Gap velocity γ.
    #[inline(always)]
    pub fn gap_velocity(&self, v: &Triple<W>, pusher_yield: Lanes<W>) -> Lanes<W> {
        (dot(&self.n, v) + self.gap).add_mul(self.nd, pusher_yield)
    }

    /// Slip velocity s.
    #[inline(always)]
    pub fn slip_velocity(&self, v: &Triple<W>, pusher_yield: Lanes<W>) -> Lanes<W> {
        (dot(&self.t, v) + self.slip).add_mul(self.td, pusher_yield)
    }
}

impl<const W: usize> Ncp<W> {
    /// Removes all contacts and compliance; the rest is to be overwritten.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.compliance = Lanes::ZERO;
    }

    /// Copies one lane into lane `slot` of `to`, without the open rows that pad it; what rows `to`
    /// has beyond these become open.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(&self, lane: usize, to: &mut Ncp<V>, slot: usize) {
        copy_lane(to.singles_mut(), slot, self.singles(), lane);
        let mut k = 0;
        for row in self.contacts.iter().filter(|row| row.is_present(lane)) {
            if k == to.contacts.len() {
                to.contacts.push(ContactRow::OPEN);
            }
            copy_lane(to.contacts[k].numbers_mut(), slot, row.numbers(), lane);
            k += 1;
        }
        for row in &mut to.contacts[k..] {
            copy_lane(row.numbers_mut(), slot, ContactRow::<1>::OPEN.numbers(), 0);
        }
    }

    /// What does not belong to a contact.
    #[inline(always)]
    fn singles(&self) -> [&Lanes<W>; 14] {
        let ([x, y, turn], [a, b, c]) = (&self.free, &self.feet);
        let [stall, compliance] = [&self.stall, &self.compliance];
        [
            x, y, turn, &a.jx, &a.jy, &a.bound, &b.jx, &b.jy, &b.bound, &c.jx, &c.jy, &c.bound,
            stall, compliance,
        ]
    }

    #[inline(always)]
    fn singles_mut(&mut self) -> [&mut Lanes<W>; 14] {
        let ([x, y, turn], [a, b, c]) = (&mut self.free, &mut self.feet);
        let [stall, compliance] = [&mut self.stall, &mut self.compliance];
        [
            x,
            y,
            turn,
            &mut a.jx,
            &mut a.jy,
            &mut a.bound,
            &mut b.jx,
            &mut b.jy,
            &mut b.bound,
            &mut c.jx,
            &mut c.jy,
            &mut c.bound,
            stall,
            compliance,
        ]
    }

    /// No contact, no friction, at rest; a workspace to fill.
    pub fn empty() -> Self {
        let foot = FootRow {
            jx: Lanes::ZERO,
            jy: Lanes::ZERO,
            bound: Lanes::ZERO,
        };
        let contacts = Vec::with_capacity(ROOM);
        Self {
            free: [Lanes::ZERO; 3],
            feet: [foot; 3],
            contacts,
            stall: Lanes::splat(f64::INFINITY),
            compliance: Lanes::ZERO,
        }
    }

    /// The largest speed that appears in a problem (m/s); its natural scale.
    #[inline(always)]
    pub fn speed_scale(&self) -> Lanes<W> {
        let mut largest = dot(&self.free, &self.free).sqrt().max(Lanes::splat(1e-9));
        for row in &self.contacts {
            let gap = row.gap.lt(Lanes::splat(FAR)).zero_unless(row.gap.abs());
            largest = largest.max(gap).max(row.slip.abs());
        }
        self.feet
            .iter()
            .fold(largest, |largest, foot| largest.max(foot.bound))
    }

    /// Velocity that follows from the impulses by the Newton–Euler rows.
    #[inline(always)]
    pub fn velocity(&self, p: &Impulses<W>) -> Triple<W> {
        let mut v = self.free;
        for (foot, p) in self.feet.iter().zip(&p.feet) {
            foot.add_wrench(&mut v, p);
        }
        for (row, (p_n, p_t)) in self.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            add_scaled(&mut v, &row.n, *p_n);
            add_scaled(&mut v, &row.t, *p_t);
        }
        v
    }

    /// F / m: the impulse with which the object resists the pusher along d.
    #[inline(always)]
    pub fn resistance(&self, p: &Impulses<W>) -> Lanes<W> {
        let mut force = Lanes::ZERO;
        for (row, (p_n, p_t)) in self.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            force = force.add_mul(*p_n, row.nd).add_mul(*p_t, row.td);
        }
        force
    }

    /// Velocity that follows from the impulses, less the velocity in `p`.
    #[inline(always)]
    pub fn imbalance(&self, p: &Impulses<W>) -> Triple<W> {
        let [x, y, turn] = self.velocity(p);
        [x - p.v[0], y - p.v[1], turn - p.v[2]]
    }

    /// The natural-map residual (m/s): the largest violation of any row of eq. (1)–(2), the
    /// certificate of a solution.
    pub fn residual(&self, p: &Impulses<W>) -> Lanes<W> {
        NaturalMap::default().take(self, p)
    }
}

/// The largest size of some numbers; NaN is larger than all.
#[derive(Clone, Copy, Debug)]
pub struct Worst<const W: usize>(Lanes<W>);

impl<const W: usize> Worst<W> {
    /// Of no number.
    pub const NONE: Self = Self(Lanes::ZERO);

    /// Takes one more number in.
    #[inline(always)]
    pub fn note(&mut self, number: Lanes<W>) {
        let Self(worst) = self;
        // sizes are ordered as their bits are, NaN after infinity
        for (worst, number) in worst.0.iter_mut().zip(number.0) {
            let size = number.abs().to_bits() as i64;
            *worst = f64::from_bits(size.max(worst.to_bits() as i64) as u64);
        }
    }

    /// The largest size; infinite for NaN.
    #[inline(always)]
    pub fn size(self) -> Lanes<W> {
        let infinity = Lanes::splat(f64::INFINITY);
        self.0.lt(infinity).select(self.0, infinity)
    }

    /// The largest size of numbers whose squares were noted.
    #[inline(always)]
    pub fn root(self) -> Lanes<W> {
        self.0.sqrt()
    }
}

impl<const W: usize> Ncp<W> {
    /// Fills these problems from ones in SI units; memory is reused, shorter contact lists are
    /// padded with open rows.
    pub fn assign(&mut self, problems: &[StepProblem; W]) {
        let rows = problems.iter().map(|p| p.contacts.len()).max().unwrap_or(0);
        self.contacts.clear();
        self.contacts.resize(rows, ContactRow::OPEN);
        self.compliance = Lanes::ZERO;
        for (lane, problem) in problems.iter().enumerate() {
            self.assign_lane(lane, problem);
        }
    }

    fn assign_lane(&mut self, lane: usize, problem: &StepProblem) {
        let m = problem.mass;
        let rho = (problem.inertia / m).sqrt();
        self.free[0].0[lane] = problem.twist.vx + problem.applied.fx / m;
        self.free[1].0[lane] = problem.twist.vy + problem.applied.fy / m;
        self.free[2].0[lane] =
            rho * (problem.twist.omega + problem.applied.torque / problem.inertia);
        self.stall.0[lane] = problem
            .stall
            .map_or(f64::INFINITY, |stall| stall.impulse / m);
        for (row, foot) in self.feet.iter_mut().zip(&problem.feet) {
            row.jx.0[lane] = -foot.arm[1] / rho;
            row.jy.0[lane] = foot.arm[0] / rho;
            row.bound.0[lane] = foot.bound / m;
        }
        let direction = problem.stall.map_or([0.0; 2], |stall| stall.direction);
        for (row, contact) in self.contacts.iter_mut().zip(&problem.contacts) {
            let d = if contact.on_pusher {
                direction
            } else {
                [0.0; 2]
            };
            row.set_lane(lane, contact, d, Scale { rho, h: problem.h });
        }
    }
}

/// What turns SI rows into mass-normalised ones.
#[derive(Clone, Copy)]
struct Scale {
    rho: f64,
    h: f64,
}

impl<const W: usize> ContactRow<W> {
    /// Overwrites one lane; `d` is the direction in which the other body may give way.
    fn set_lane(&mut self, lane: usize, c: &ContactPoint, d: [f64; 2], scale: Scale) {
        let n = c.normal;
        let t = [-n[1], n[0]];
        let along = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let moment = |a: [f64; 2]| (c.arm[0] * a[1] - c.arm[1] * a[0]) / scale.rho;
        for (column, direction) in [(&mut self.n, n), (&mut self.t, t)] {
            column[0].0[lane] = direction[0];
            column[1].0[lane] = direction[1];
            column[2].0[lane] = moment(direction);
        }
        self.gap.0[lane] = c.gap / scale.h - along(n, c.surface_velocity);
        self.slip.0[lane] = -along(t, c.surface_velocity);
        self.nd.0[lane] = along(n, d);
        self.td.0[lane] = along(t, d);
        self.mu.0[lane] = c.mu;
    }
}
