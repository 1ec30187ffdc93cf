//! The natural map of the mixed NCP at one point: [`NaturalMap`], what the certificate and the fast
//! solver share.
//!
//! Its zeros are the solutions. A foot's row is p − Π(p − s), Π the projection on the friction
//! disc; a contact's rows are min(p_n, γ) and p_t − clamp(p_t − s, ±μ p_n); the stall row is
//! min(F_stall − F, y).

use stickslip_lanes::{Lanes, copy_lane};

use crate::ncp::rows::{ContactRow, Ncp, ROOM, Triple, Worst, square};
use crate::ncp::unknowns::Impulses;

/// Keeps quotients finite.
pub const TINY: f64 = 1e-300;

/// The natural map at one point, with what leads to it.
#[derive(Clone, Debug)]
pub struct NaturalMap<const W: usize> {
    /// Velocity that follows from the impulses, less the point's.
    pub imbalance: Triple<W>,
    /// Slip velocity s of each foot.
    pub slips: [[Lanes<W>; 2]; 3],
    /// One per contact.
    pub contacts: Vec<ContactMap<W>>,
    /// F_stall − F.
    pub slack: Lanes<W>,
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
        Self {
            imbalance: [o; 3],
            slips: [[o; 2]; 3],
            contacts: Vec::with_capacity(ROOM),
            slack: o,
        }
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
        for (slip, (foot, p_k)) in self.slips.iter_mut().zip(ncp.feet.iter().zip(&p.feet)) {
            *slip = foot.slip(&p.v);
            squares.note(square(&miss(foot.bound, p_k, slip)));
        }
        worst.note(squares.root());
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gap = row
                .gap_velocity(&p.v, p.pusher_yield)
                .add_mul(ncp.compliance, *p_n);
            worst.note(p_n.min(gap));
            let mut slip = Lanes::ZERO;
            // where a contact carries nothing and stays open in every lane, its slip makes no
            // difference
            if ((p_n.abs() + p_t.abs()).gt(Lanes::ZERO) | gap.lt(Lanes::ZERO)).any() {
                slip = row.slip_velocity(&p.v, p.pusher_yield);
                worst.note(slip_violation(row, slip, [*p_n, *p_t]));
            }
            self.contacts.push(ContactMap { gap, slip });
        }
        worst.size()
    }

    /// Copies one lane of `ncp` into lane `slot` of `to`, a map of `contacts` contacts, without the
    /// rows that pad it.
    #[inline(always)]
    pub fn pack_lane(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut Self,
        contacts: usize,
        slot: usize,
    ) {
        copy_lane(to.singles_mut(), slot, self.singles(), lane);
        to.contacts.resize(contacts, ContactMap::OPEN);
        let mut k = 0;
        for (map, _) in self
            .contacts
            .iter()
            .zip(&ncp.contacts)
            .filter(|(_, row)| row.is_present(lane))
        {
            to.contacts[k].gap.0[slot] = map.gap.0[lane];
            to.contacts[k].slip.0[slot] = map.slip.0[lane];
            k += 1;
        }
        for map in &mut to.contacts[k..] {
            let ContactMap { gap, slip } = ContactMap::<1>::OPEN;
            (map.gap.0[slot], map.slip.0[slot]) = (gap.0[0], slip.0[0]);
        }
    }

    /// What does not belong to a contact.
    #[inline(always)]
    fn singles(&self) -> [&Lanes<W>; 10] {
        let ([x, y, turn], [[ax, ay], [bx, by], [cx, cy]]) = (&self.imbalance, &self.slips);
        [x, y, turn, ax, ay, bx, by, cx, cy, &self.slack]
    }

    #[inline(always)]
    fn singles_mut(&mut self) -> [&mut Lanes<W>; 10] {
        let ([x, y, turn], [[ax, ay], [bx, by], [cx, cy]]) = (&mut self.imbalance, &mut self.slips);
        [x, y, turn, ax, ay, bx, by, cx, cy, &mut self.slack]
    }
}

/// Π(p − s) − p of a foot.
#[inline(always)]
fn miss<const W: usize>(bound: Lanes<W>, p: &[Lanes<W>; 2], slip: &[Lanes<W>; 2]) -> [Lanes<W>; 2] {
    let z = [p[0] - slip[0], p[1] - slip[1]];
    let size = square(&z);
    let sliding = size.gt(bound * bound);
    let shrink = bound * size.inverse_sqrt();
    [
        sliding.select((-p[0]).add_mul(shrink, z[0]), -slip[0]),
        sliding.select((-p[1]).add_mul(shrink, z[1]), -slip[1]),
    ]
}

impl<const W: usize> ContactMap<W> {
    /// Of a row that only pads.
    const OPEN: Self = Self {
        gap: ContactRow::<W>::OPEN.gap,
        slip: Lanes::ZERO,
    };
}

/// The friction row of a contact: p_t − clamp(p_t − s, ±μ p_n).
#[inline(always)]
fn slip_violation<const W: usize>(
    row: &ContactRow<W>,
    slip: Lanes<W>,
    [p_n, p_t]: [Lanes<W>; 2],
) -> Lanes<W> {
    let bound = row.mu * p_n.max(Lanes::ZERO);
    p_t - (p_t - slip).min(bound).max(-bound)
}
