//! The natural map of the mixed NCP at one point: [`NaturalMap`], what the certificate and the fast solver share.
//!
//! Its zeros are the solutions. A foot's row is p − Π(p − s), Π the projection on the friction disc; a contact's rows are
//! min(p_n, γ) and p_t − clamp(p_t − s, ±μ p_n); the stall row is min(F_stall − F, y).

use crate::impulses::Impulses;
use crate::lanes::{Lanes, Mask};
use crate::ncp::{ContactRow, FootRow, Ncp, ROOM, Triple, Worst};

/// Smallest excess of |p − s| over a foot's bound that counts, as a share of the bound.
const LEAST_EXCESS: f64 = 1e-8;

/// Keeps quotients finite.
const TINY: f64 = 1e-300;

/// The natural map at one point, with what leads to it.
#[derive(Clone, Debug)]
pub struct NaturalMap<const W: usize> {
    /// Velocity that follows from the impulses, less the point's.
    pub imbalance: Triple<W>,
    /// One per foot.
    pub feet: [FootMap<W>; 3],
    /// One per contact.
    pub contacts: Vec<ContactMap<W>>,
    /// F_stall − F.
    pub slack: Lanes<W>,
}

/// One foot.
#[derive(Clone, Copy, Debug)]
pub struct FootMap<const W: usize> {
    /// Slip velocity s.
    pub slip: [Lanes<W>; 2],
    /// |p − s| is above the bound.
    pub sliding: Mask<W>,
    /// (p − s) / |p − s| where sliding.
    pub direction: [Lanes<W>; 2],
    /// bound / (|p − s| − bound) where sliding.
    pub across: Lanes<W>,
}

/// One contact.
#[derive(Clone, Copy, Debug)]
pub struct ContactMap<const W: usize> {
    /// Gap velocity γ + κ p_n.
    pub gap: Lanes<W>,
    /// Slip velocity s.
    pub slip: Lanes<W>,
}

impl<const W: usize> Default for NaturalMap<W> {
    fn default() -> Self {
        let o = Lanes::ZERO;
        let foot = FootMap { slip: [o; 2], sliding: Mask::splat(false), direction: [o; 2], across: o };
        Self { imbalance: [o; 3], feet: [foot; 3], contacts: Vec::with_capacity(ROOM), slack: o }
    }
}

impl<const W: usize> NaturalMap<W> {
    /// Takes the map at `p`; returns its largest row (m/s).
    #[inline(always)]
    pub fn take(&mut self, ncp: &Ncp<W>, p: &Impulses<W>) -> Lanes<W> {
        self.imbalance = ncp.imbalance(p);
        self.slack = ncp.stall - ncp.resistance(p);
        let mut worst = Worst::NONE;
        worst.note(self.slack.min(p.pusher_yield));
        for off in self.imbalance {
            worst.note(off);
        }
        let mut squares = Worst::NONE;
        for (map, (foot, p_k)) in self.feet.iter_mut().zip(ncp.feet.iter().zip(&p.feet)) {
            *map = FootMap::new(foot, p_k, &p.v);
            let [x, y] = map.miss(foot, p_k);
            squares.note(x * x + y * y);
        }
        worst.note(squares.root());
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let map = ContactMap::new(row, *p_n, p, ncp.compliance);
            for row in map.violations(row, [*p_n, *p_t]) {
                worst.note(row);
            }
            self.contacts.push(map);
        }
        worst.size()
    }
}

impl<const W: usize> FootMap<W> {
    #[inline(always)]
    fn new(foot: &FootRow<W>, p: &[Lanes<W>; 2], v: &Triple<W>) -> Self {
        let slip = foot.slip(v);
        let z = [p[0] - slip[0], p[1] - slip[1]];
        let length = (z[0] * z[0] + z[1] * z[1]).sqrt();
        let sliding = length.gt(foot.bound);
        let excess = (length - foot.bound).max(foot.bound * LEAST_EXCESS);
        // one division for both 1 / length and 1 / excess
        let both = sliding.select(length * excess, Lanes::splat(1.0)).max(Lanes::splat(TINY));
        let inverse = Lanes::splat(1.0) / both;
        let unit = inverse * excess;
        Self { slip, sliding, direction: [z[0] * unit, z[1] * unit], across: foot.bound * (inverse * length) }
    }

    /// Π(p − s) − p.
    #[inline(always)]
    pub fn miss(&self, foot: &FootRow<W>, p: &[Lanes<W>; 2]) -> [Lanes<W>; 2] {
        let [x, y] = self.direction;
        [self.sliding.select(foot.bound * x - p[0], -self.slip[0]), self.sliding.select(foot.bound * y - p[1], -self.slip[1])]
    }
}

impl<const W: usize> ContactMap<W> {
    #[inline(always)]
    fn new(row: &ContactRow<W>, p_n: Lanes<W>, p: &Impulses<W>, compliance: Lanes<W>) -> Self {
        Self { gap: row.gap_velocity(&p.v, p.pusher_yield) + compliance * p_n, slip: row.slip_velocity(&p.v, p.pusher_yield) }
    }

    /// The contact's two rows.
    #[inline(always)]
    fn violations(&self, row: &ContactRow<W>, [p_n, p_t]: [Lanes<W>; 2]) -> [Lanes<W>; 2] {
        let bound = row.mu * p_n.max(Lanes::ZERO);
        let slides_to = (p_t - self.slip).min(bound).max(-bound);
        [p_n.min(self.gap), p_t - slides_to]
    }
}
