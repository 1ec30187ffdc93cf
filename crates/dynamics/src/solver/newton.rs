//! The fast solver: a semismooth Newton iteration on the natural map of the mixed NCP, `W`
//! particles side by side.
//!
//! Every row is either held (its velocity is driven to zero) or given (its impulse is known up to
//! the other rows), decided by the natural map of the iterate as in Alart & Curnier (1991), in
//! which slips have weights of their own. Held rows enter with a finite stiffness k and keep their
//! impulse from one iteration to the next (a method of multipliers), so that redundant contacts do
//! no harm. The error shrinks by K/(K + k) an iteration once the modes are right, K what else
//! resists; a particle's warm start is its last step's impulses. Stiff rows answer sooner, soft
//! ones where modes contradict each other: the iterations take turns.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::natural_map::{ContactMap, NaturalMap, TINY};
use crate::ncp::rows::{self, ContactRow, Ncp};
use crate::ncp::unknowns::Impulses;
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};

/// Stiffness k of held rows, in units of the object's mass per step: well above that of sliding
/// feet, bound / slip speed, which hold a jammed object's creep of 1e-8 m/s.
const STIFF: f64 = 5.0e8;

/// The same where stiff iterations have come to nothing: softer by what impulses of rows that
/// contradict each other may grow.
const SOFT: f64 = 3.0e6;

/// So many iterations are stiff, as many soft, and so on.
const TURN: f64 = 8.0;

/// Weight of slip against impulse where feet near a solution are told to stick or slide.
pub const NEAR: f64 = 2.0e8;

/// Weight of impulse against slip where closed contacts are told so, in units of the inertia that
/// resists the slip.
const CONTACT: f64 = 4.0;

/// When the iteration ends.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Residual aimed at (m/s).
    pub residual: f64,
    /// Most iterations.
    pub iterations: u32,
    /// Weight k of slip against impulse where feet are told to stick or slide: [`NEAR`] a solution,
    /// 1 from afar.
    pub weight: f64,
}

/// How long all lanes of a chunk iterate, whether open or not.
#[derive(Clone, Copy, Debug)]
pub struct Together {
    /// Most iterations.
    pub iterations: u32,
    /// Open lanes for which one is worth it, at least 1.
    pub lanes: u32,
}

impl Together {
    /// Until no lane is open.
    #[inline(always)]
    pub fn to_the_end(goal: &Goal) -> Self {
        Self {
            iterations: goal.iterations,
            lanes: 1,
        }
    }
}

/// The fast solver's working memory.
#[derive(Clone, Debug)]
pub struct Newton<const W: usize> {
    map: NaturalMap<W>,
    linearised: Linearised<W>,
}

impl<const W: usize> Default for Newton<W> {
    fn default() -> Self {
        Self {
            map: NaturalMap::default(),
            linearised: Linearised::default(),
        }
    }
}

/// How far each lane is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<const W: usize> {
    /// Residual at the present point (m/s).
    pub residual: Lanes<W>,
    /// Iterations taken.
    pub iterations: Lanes<W>,
    /// Lanes that have neither reached their goal nor taken all iterations.
    pub open: Mask<W>,
}

impl<const W: usize> Progress<W> {
    /// Nothing to do.
    pub const NONE: Self = Self {
        residual: Lanes::ZERO,
        iterations: Lanes::ZERO,
        open: Mask::splat(false),
    };

    /// Copies one lane into lane `slot` of `to`.
    #[inline(always)]
    pub fn pack_lane(&self, lane: usize, to: &mut Self, slot: usize) {
        to.residual.0[slot] = self.residual.0[lane];
        to.iterations.0[slot] = self.iterations.0[lane];
        to.open.set(slot, self.open.lane(lane));
    }
}

impl<const W: usize> Newton<W> {
    /// Iterates from `p` (velocity and impulses) until every lane has reached its goal or taken all
    /// iterations; returns the residuals.
    #[inline(always)]
    pub fn solve(&mut self, ncp: &Ncp<W>, p: &mut Impulses<W>, goal: Goal) -> Lanes<W> {
        self.begin(ncp, p, goal, Together::to_the_end(&goal))
            .residual
    }

    /// The same while it is worth it for all lanes together.
    #[inline(always)]
    pub fn begin(
        &mut self,
        ncp: &Ncp<W>,
        p: &mut Impulses<W>,
        goal: Goal,
        together: Together,
    ) -> Progress<W> {
        let residual = self.map.take(ncp, p);
        let mut progress = Progress {
            residual,
            iterations: Lanes::ZERO,
            open: residual.gt(Lanes::splat(goal.residual)),
        };
        for _ in 0..together.iterations {
            if progress.open.count() < together.lanes {
                break;
            }
            self.advance(ncp, p, goal, &mut progress);
        }
        progress
    }

    /// One iteration of the open lanes, from the point that they have come to.
    ///
    /// Lanes that are done keep their result while others go on, so a lane's bits do not depend on
    /// its neighbours.
    #[inline(always)]
    pub fn advance(
        &mut self,
        ncp: &Ncp<W>,
        p: &mut Impulses<W>,
        goal: Goal,
        progress: &mut Progress<W>,
    ) {
        let Progress {
            residual,
            iterations,
            open,
        } = progress;
        self.linearised
            .by_natural_map(ncp, p, &self.map, goal.weight, stiffness(*iterations));
        self.linearised.step(ncp, p, *open);
        *residual = open.select(self.map.take(ncp, p), *residual);
        *iterations += open.zero_unless(Lanes::splat(1.0));
        *open = *open
            & residual.gt(Lanes::splat(goal.residual))
            & iterations.lt(Lanes::splat(f64::from(goal.iterations)));
    }

    /// Copies what one lane of `ncp` has come to into lane `slot` of `to`, whose problems are
    /// `packed`.
    #[inline(always)]
    pub fn pack_lane(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut Self,
        packed: &Ncp<W>,
        slot: usize,
    ) {
        self.map
            .pack_lane(ncp, lane, &mut to.map, packed.contacts.len(), slot);
    }
}

/// Stiffness of the next iteration of lanes that have taken `iterations`.
#[inline(always)]
fn stiffness<const W: usize>(iterations: Lanes<W>) -> Lanes<W> {
    let turn = (iterations + 0.5) * (0.5 / TURN);
    let soft = (turn - (turn - 0.5).round()).gt(Lanes::splat(0.5));
    soft.select(Lanes::splat(SOFT), Lanes::splat(STIFF))
}

impl<const W: usize> Linearised<W> {
    /// The natural map's own choice of modes at `p`, where it is `map`.
    #[inline(always)]
    fn by_natural_map(
        &mut self,
        ncp: &Ncp<W>,
        p: &Impulses<W>,
        map: &NaturalMap<W>,
        weight: f64,
        stiffness: Lanes<W>,
    ) {
        self.imbalance = map.imbalance;
        for k in 0..3 {
            self.feet[k] = FootStep::decided(
                ncp.feet[k].bound,
                &p.feet[k],
                &map.slips[k],
                weight,
                stiffness,
            );
        }
        self.contacts.clear();
        let hold = Hold::new(stiffness, ncp.compliance);
        let points = p.normal.iter().zip(&p.tangential);
        for (i, ((row, contact), (p_n, p_t))) in ncp
            .contacts
            .iter()
            .zip(&map.contacts)
            .zip(points)
            .enumerate()
        {
            if let Some(step) = contact.linearised(row, [*p_n, *p_t], &hold) {
                self.contacts.push((i, step));
            }
        }
        self.stall = StallStep::decided(p.pusher_yield.gt(map.slack), map.slack, p.pusher_yield);
    }
}

/// What it would take to hold a foot: the impulse z = p − k s, k the weight of slip against
/// impulse.
#[derive(Clone, Copy, Debug)]
pub struct Holding<const W: usize> {
    z: [Lanes<W>; 2],
    /// |z|².
    square: Lanes<W>,
    /// k.
    weight: f64,
}

impl<const W: usize> Holding<W> {
    /// Of a foot with impulse p and slip velocity s.
    #[inline(always)]
    pub fn new(p: &[Lanes<W>; 2], slip: &[Lanes<W>; 2], weight: f64) -> Self {
        let k = Lanes::splat(weight);
        let z = [p[0].sub_mul(k, slip[0]), p[1].sub_mul(k, slip[1])];
        Self {
            z,
            square: rows::square(&z),
            weight,
        }
    }
}

impl<const W: usize> FootStep<W> {
    /// A foot that sticks while what would hold it is within its bound, else slides.
    #[inline(always)]
    fn decided(
        bound: Lanes<W>,
        p: &[Lanes<W>; 2],
        slip: &[Lanes<W>; 2],
        weight: f64,
        stiffness: Lanes<W>,
    ) -> Self {
        let holding = Holding::new(p, slip, weight);
        Self::in_mode(
            bound,
            p,
            slip,
            &holding,
            holding.square.gt(bound * bound),
            stiffness,
        )
    }

    /// A foot that slides where `slides`, with p = bound z / |z|; elsewhere its slip is driven to
    /// zero with `stiffness`.
    ///
    /// Sliding is linearised with p itself, kept inside its disc, in place of bound z / |z|
    /// (Andersen et al. 2000): far from the solution, where p and s do not oppose each other yet,
    /// the impulse then does not turn too far.
    #[inline(always)]
    pub fn in_mode(
        bound: Lanes<W>,
        p: &[Lanes<W>; 2],
        slip: &[Lanes<W>; 2],
        holding: &Holding<W>,
        slides: Mask<W>,
        stiffness: Lanes<W>,
    ) -> Self {
        let held = [-slip[0] * stiffness, -slip[1] * stiffness];
        let Holding { z, square, weight } = *holding;
        let unit = square.inverse_sqrt();
        // k |s|, where it slides
        let speed = (-bound).add_mul(square, unit).max(bound);
        let rim = bound * bound;
        let size = rows::square(p).max(rim);
        // one division for k / speed and the share of p that is inside the disc
        let inverse = Lanes::splat(1.0) / (speed * size).max(Lanes::splat(TINY));
        // in this order a foot without a bound has 0 here, however fast it slips
        let inside = inverse * rim * weight;
        let full = inverse * size * weight * bound;
        let u = [z[0] * unit, z[1] * unit];
        let q = [p[0] * inside, p[1] * inside];
        Self {
            r: [
                slides.select((-p[0]).add_mul(bound, u[0]), held[0]),
                slides.select((-p[1]).add_mul(bound, u[1]), held[1]),
            ],
            k: [
                [
                    slides.select(full.sub_mul(q[0], u[0]), stiffness),
                    slides.zero_unless(-q[0] * u[1]),
                ],
                [
                    slides.zero_unless(-q[1] * u[0]),
                    slides.select(full.sub_mul(q[1], u[1]), stiffness),
                ],
            ],
        }
    }
}

impl<const W: usize> ContactMap<W> {
    /// Open, sticking or sliding either way; `None` where it is open in every lane and carries
    /// nothing.
    #[inline(always)]
    fn linearised(
        &self,
        row: &ContactRow<W>,
        p: [Lanes<W>; 2],
        hold: &Hold<W>,
    ) -> Option<ContactStep<W>> {
        let one = Lanes::splat(1.0);
        let closed = (p[0] * one.add_mul(row.n[2], row.n[2])).gt(self.gap);
        if !(closed.any() || (p[0].abs() + p[1].abs()).gt(Lanes::ZERO).any()) {
            return None;
        }
        let inertia = one.add_mul(row.t[2], row.t[2]) * CONTACT;
        let z = (-self.slip).add_mul(p[1], inertia);
        let sliding = z.abs().gt(row.mu * p[0].max(Lanes::ZERO) * inertia);
        let mode = Mode {
            closed,
            sliding,
            ratio: z.sign() * row.mu,
        };
        Some(ContactStep::in_mode(p, [self.gap, self.slip], mode, hold))
    }
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

/// How hard a contact's held rows are held, in units of the object's mass per step.
#[derive(Clone, Copy, Debug)]
pub struct Hold<const W: usize> {
    gap: Lanes<W>,
    slip: Lanes<W>,
}

impl<const W: usize> Hold<W> {
    /// With stiffness k, in the gap row in series with its compliance κ.
    #[inline(always)]
    pub fn new(stiffness: Lanes<W>, compliance: Lanes<W>) -> Self {
        // bodies are rigid but where no solution exists: no division then
        let yields = compliance.gt(Lanes::ZERO).any();
        let gap = if yields {
            stiffness / Lanes::splat(1.0).add_mul(compliance, stiffness)
        } else {
            stiffness
        };
        Self {
            gap,
            slip: stiffness,
        }
    }
}

impl<const W: usize> ContactStep<W> {
    /// A contact of impulses `p` and velocities (γ, s) in a given mode.
    #[inline(always)]
    pub fn in_mode(
        p: [Lanes<W>; 2],
        [gamma, slip]: [Lanes<W>; 2],
        mode: Mode<W>,
        hold: &Hold<W>,
    ) -> Self {
        let n = mode.closed.select(-gamma * hold.gap, -p[0]);
        let nn = mode.closed.zero_unless(hold.gap);
        let free = mode.sliding | !mode.closed;
        Self {
            n,
            t: free.select((-p[1]).add_mul(mode.ratio, p[0] + n), -slip * hold.slip),
            nn,
            tn: free.zero_unless(mode.ratio * nn),
            tt: free.select(Lanes::ZERO, hold.slip),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foot_without_friction_lets_go_of_its_impulse_however_fast_it_slips() {
        let vector = |x: f64| [Lanes([x]), Lanes([-0.5 * x])];
        for slip in [1e-12, 1e-3, 1.0, 1e6] {
            for p in [0.0, 1e-6, 3.0] {
                let step =
                    FootStep::decided(Lanes::ZERO, &vector(p), &vector(slip), NEAR, Lanes([STIFF]));
                assert_eq!(step.r, vector(p).map(|p| -p), "slip {slip}, impulse {p}");
                assert_eq!(step.k, [[Lanes::ZERO; 2]; 2], "slip {slip}, impulse {p}");
            }
        }
    }
}
