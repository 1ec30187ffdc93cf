//! The mixed NCP of one step in mass-normalised units, `W` particles side by side: [`Ncp`] and its
//! rows.
//!
//! Impulses are divided by the mass m and rotation is scaled by the radius of gyration ρ. So every
//! number is a speed (m/s) and the mass matrix is the identity. The velocity is v = (vx, vy, ρ ω).
//! The rows are W_n = (n, r × n / ρ), W_t = (t, r × t / ρ).

use stickslip_lanes::Lanes;

use crate::ncp::problem::{ContactPoint, StepProblem};

/// Largest speed of a solution, in terms of the fastest one that its problem asks for. A face that
/// closes on an object at an angle of two degrees squeezes it out that much faster; of 18 million
/// solved steps of random scenes three were faster by 32 and ten by eight. Faster still are only
/// solutions of wedges that friction all but locks: impulses of 1e6 m/s throw an object out at some
/// 100 m/s where all else moves at 0.1.
const SPEED_LIMIT: f64 = 30.0;

/// No problem's is less (m/s).
pub const LEAST_SPEED_LIMIT: f64 = 1.0;

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
#[derive(Clone, Copy, Debug, Default)]
pub struct FootRow<const W: usize> {
    /// −r_y / ρ.
    pub jx: Lanes<W>,
    /// r_x / ρ.
    pub jy: Lanes<W>,
    /// Largest friction impulse over m (m/s).
    pub bound: Lanes<W>,
}

/// One contact: gap velocity γ = n·v + `gap_offset` + nd y, slip velocity s = t·v + `slip_offset` +
/// td y.
#[derive(Clone, Copy, Debug)]
pub struct ContactRow<const W: usize> {
    /// Column W_n.
    pub n: Triple<W>,
    /// Column W_t.
    pub t: Triple<W>,
    /// Part of the gap velocity that does not depend on the unknowns: ψ/h − n·u (m/s).
    pub gap_offset: Lanes<W>,
    /// Part of the slip velocity that does not depend on the unknowns: −t·u (m/s).
    pub slip_offset: Lanes<W>,
    /// n·d on the pusher, 0 elsewhere: how fast the gap opens per unit of y.
    pub nd: Lanes<W>,
    /// t·d on the pusher, 0 elsewhere.
    pub td: Lanes<W>,
    /// Friction coefficient μ.
    pub mu: Lanes<W>,
}

/// Contacts for which working memory has room from the start, so that a buffer first needed late in
/// a run does not allocate then.
pub(crate) const ROOM: usize = 16;

/// Gap offset of padding rows (m/s): so large that no smoothing reaches them.
const FAR: f64 = 1e30;

/// `W` mixed NCPs with equally many contact rows; a particle with fewer contacts is padded with
/// [`ContactRow::OPEN`].
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
    /// Compliance κ of the gap rows: 0, or κ of docs/method.md (14) where no exact solution exists.
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
    /// A padding row: it never touches, and its impulses act on nothing.
    pub const OPEN: Self = Self {
        n: [Lanes::ZERO; 3],
        t: [Lanes::ZERO; 3],
        gap_offset: Lanes::splat(FAR),
        slip_offset: Lanes::ZERO,
        nd: Lanes::ZERO,
        td: Lanes::ZERO,
        mu: Lanes::ZERO,
    };

    /// Returns true if a lane has this contact, rather than padding.
    #[inline(always)]
    pub fn is_present(&self, lane: usize) -> bool {
        self.n[0].0[lane] != 0.0 || self.n[1].0[lane] != 0.0
    }

    /// Gap velocity γ.
    #[inline(always)]
    pub fn gap_velocity(&self, v: &Triple<W>, pusher_yield: Lanes<W>) -> Lanes<W> {
        (dot(&self.n, v) + self.gap_offset).add_mul(self.nd, pusher_yield)
    }

    /// Slip velocity s.
    #[inline(always)]
    pub fn slip_velocity(&self, v: &Triple<W>, pusher_yield: Lanes<W>) -> Lanes<W> {
        (dot(&self.t, v) + self.slip_offset).add_mul(self.td, pusher_yield)
    }

    /// Makes it a contact of a body that yields along `direction`. The body moves at `catch_up`
    /// (m/s) in addition to its commanded velocity, which its gap includes already.
    #[inline(always)]
    pub fn let_yield(&mut self, [dx, dy]: [Lanes<W>; 2], [x, y]: [Lanes<W>; 2]) {
        self.nd = self.n[0] * dx + self.n[1] * dy;
        self.td = self.t[0] * dx + self.t[1] * dy;
        self.slip_offset -= self.t[0] * x + self.t[1] * y;
    }

    /// Copies one lane into lane `slot` of `to`.
    #[inline(always)]
    pub(crate) fn copy_lane<const V: usize>(
        &self,
        lane: usize,
        to: &mut ContactRow<V>,
        slot: usize,
    ) {
        for k in 0..3 {
            to.n[k].0[slot] = self.n[k].0[lane];
            to.t[k].0[slot] = self.t[k].0[lane];
        }
        to.gap_offset.0[slot] = self.gap_offset.0[lane];
        to.slip_offset.0[slot] = self.slip_offset.0[lane];
        to.nd.0[slot] = self.nd.0[lane];
        to.td.0[slot] = self.td.0[lane];
        to.mu.0[slot] = self.mu.0[lane];
    }

    /// Overwrites one lane with a contact of `problem`.
    fn assign_lane(&mut self, lane: usize, c: &ContactPoint, problem: &StepProblem) {
        let rho = (problem.inertia / problem.mass).sqrt();
        let n = c.normal;
        let t = [-n[1], n[0]];
        // the direction in which the other body may yield
        let d = c.yields.filter(|_| problem.stall.is_some());
        let d = d.unwrap_or_default();
        let along = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        for (column, direction) in [(&mut self.n, n), (&mut self.t, t)] {
            column[0].0[lane] = direction[0];
            column[1].0[lane] = direction[1];
            column[2].0[lane] = (c.arm[0] * direction[1] - c.arm[1] * direction[0]) / rho;
        }
        self.gap_offset.0[lane] = c.gap / problem.h - along(n, c.surface_velocity);
        self.slip_offset.0[lane] = -along(t, c.surface_velocity);
        self.nd.0[lane] = along(n, d);
        self.td.0[lane] = along(t, d);
        self.mu.0[lane] = c.mu;
    }
}

impl<const W: usize> Default for Ncp<W> {
    /// No contact, no friction, at rest; a workspace to fill.
    fn default() -> Self {
        Self {
            free: [Lanes::ZERO; 3],
            feet: [FootRow::default(); 3],
            contacts: Vec::with_capacity(ROOM),
            stall: Lanes::splat(f64::INFINITY),
            compliance: Lanes::ZERO,
        }
    }
}

impl<const W: usize> Ncp<W> {
    /// Removes all contacts and compliance; the caller overwrites the rest.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.compliance = Lanes::ZERO;
    }

    /// Copies all lanes; memory is reused.
    pub fn copy_from(&mut self, from: &Self) {
        self.free = from.free;
        self.feet = from.feet;
        self.contacts.clone_from(&from.contacts);
        self.stall = from.stall;
        self.compliance = from.compliance;
    }

    /// Fills these problems from ones in SI units; memory is reused, shorter contact lists are
    /// padded.
    pub fn assign(&mut self, problems: &[StepProblem; W]) {
        let rows = problems.iter().map(|p| p.contacts.len()).max().unwrap_or(0);
        self.clear();
        self.contacts.resize(rows, ContactRow::OPEN);
        for (lane, problem) in problems.iter().enumerate() {
            self.assign_lane(lane, problem);
        }
    }

    fn assign_lane(&mut self, lane: usize, problem: &StepProblem) {
        let (m, twist, applied) = (problem.mass, problem.twist, problem.applied);
        let rho = (problem.inertia / m).sqrt();
        self.free[0].0[lane] = twist.vx + applied.fx / m;
        self.free[1].0[lane] = twist.vy + applied.fy / m;
        self.free[2].0[lane] = rho * (twist.omega + applied.torque / problem.inertia);
        self.stall.0[lane] = problem.stall.map_or(f64::INFINITY, |impulse| impulse / m);
        for (row, foot) in self.feet.iter_mut().zip(&problem.feet) {
            row.jx.0[lane] = -foot.arm[1] / rho;
            row.jy.0[lane] = foot.arm[0] / rho;
            row.bound.0[lane] = foot.bound / m;
        }
        for (row, contact) in self.contacts.iter_mut().zip(&problem.contacts) {
            row.assign_lane(lane, contact, problem);
        }
    }

    /// Copies one lane into lane `slot` of `to`, leaving out the rows that pad it; rows that `to`
    /// has beyond these become padding.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(&self, lane: usize, to: &mut Ncp<V>, slot: usize) {
        for k in 0..3 {
            to.free[k].0[slot] = self.free[k].0[lane];
            to.feet[k].jx.0[slot] = self.feet[k].jx.0[lane];
            to.feet[k].jy.0[slot] = self.feet[k].jy.0[lane];
            to.feet[k].bound.0[slot] = self.feet[k].bound.0[lane];
        }
        to.stall.0[slot] = self.stall.0[lane];
        to.compliance.0[slot] = self.compliance.0[lane];
        let mut packed = 0;
        for row in &self.contacts {
            if row.is_present(lane) {
                if packed == to.contacts.len() {
                    to.contacts.push(ContactRow::OPEN);
                }
                row.copy_lane(lane, &mut to.contacts[packed], slot);
                packed += 1;
            }
        }
        for row in &mut to.contacts[packed..] {
            ContactRow::<1>::OPEN.copy_lane(0, row, slot);
        }
    }

    /// Largest speed of a solution (m/s): 30 times the fastest one that the problem asks for, or
    /// 1 m/s, where that is more.
    #[inline(always)]
    pub fn speed_limit(&self) -> Lanes<W> {
        let mut fastest = self
            .feet
            .iter()
            .fold(Lanes::ZERO, |fastest, foot| fastest.max(foot.bound));
        for x in &self.free {
            fastest = fastest.max(x.abs());
        }
        for row in &self.contacts {
            // open gaps ask for none; rows that pad a lane are wide open
            fastest = fastest.max(-row.gap_offset).max(row.slip_offset.abs());
        }
        (fastest * Lanes::splat(SPEED_LIMIT)).max(Lanes::splat(LEAST_SPEED_LIMIT))
    }

    /// The largest speed that appears in a problem (m/s); its natural scale.
    #[inline(always)]
    pub fn speed_scale(&self) -> Lanes<W> {
        let mut largest = dot(&self.free, &self.free).sqrt().max(Lanes::splat(1e-9));
        for row in &self.contacts {
            let present = row.gap_offset.lt(Lanes::splat(FAR));
            largest = largest
                .max(present.zero_unless(row.gap_offset.abs()))
                .max(row.slip_offset.abs());
        }
        self.feet
            .iter()
            .fold(largest, |largest, foot| largest.max(foot.bound))
    }
}
