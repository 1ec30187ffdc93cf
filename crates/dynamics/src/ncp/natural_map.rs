//! The natural map of the mixed NCP at one point: [`NaturalMap`], shared by the certificate
//! [`Ncp::residual`] and the Newton iteration (docs/method.md (16)).
//!
//! Its zeros are the solutions. A foot's row is p − Π(p − s), with Π the projection onto the
//! friction disc; a contact's rows are min(p_n, γ) and p_t − clamp(p_t − s, ±μ p_n); the stall row
//! is min((F_stall h − F)/m, y). The largest row is the residual of docs/method.md, "The
//! certificate".

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::max_abs::MaxAbs;
use crate::ncp::report::TOLERANCE;
use crate::ncp::rows::{ContactRow, Ncp, ROOM, Triple, add_scaled, square};
use crate::ncp::unknowns::Unknowns;

/// The velocities at one point on which the natural map, and its linearisation, depend.
#[derive(Clone, Debug)]
pub struct NaturalMap<const W: usize> {
    /// Velocity that follows from the impulses, less the point's.
    pub imbalance: Triple<W>,
    /// Slip velocity s of each foot.
    pub slips: [[Lanes<W>; 2]; 3],
    /// One per contact.
    pub contacts: Vec<ContactVelocity<W>>,
    /// (F_stall h − F)/m.
    pub slack: Lanes<W>,
}

/// Relative velocity of the two bodies at one contact.
#[derive(Clone, Copy, Debug)]
pub struct ContactVelocity<const W: usize> {
    /// Gap velocity γ + κ p_n.
    pub gap: Lanes<W>,
    /// Slip velocity s; 0 where it is open and carries nothing in every lane.
    pub slip: Lanes<W>,
}

impl<const W: usize> Default for NaturalMap<W> {
    fn default() -> Self {
        Self {
            imbalance: [Lanes::ZERO; 3],
            slips: [[Lanes::ZERO; 2]; 3],
            contacts: Vec::with_capacity(ROOM),
            slack: Lanes::ZERO,
        }
    }
}

impl<const W: usize> NaturalMap<W> {
    /// Evaluates the map at `z`; returns its largest row (m/s).
    #[inline(always)]
    pub fn evaluate(&mut self, ncp: &Ncp<W>, z: &Unknowns<W>) -> Lanes<W> {
        self.imbalance = ncp.imbalance(z);
        self.slack = ncp.stall - ncp.resistance(z);
        let mut largest = MaxAbs::ZERO;
        // stall pair and Newton–Euler rows
        largest.accumulate(self.slack.min(z.pusher_yield));
        for row in self.imbalance {
            largest.accumulate(row);
        }
        // feet: one root for the largest of their squared lengths
        let mut squares = MaxAbs::ZERO;
        for (slip, (foot, p_k)) in self.slips.iter_mut().zip(ncp.feet.iter().zip(&z.feet)) {
            *slip = foot.slip(&z.v);
            squares.accumulate(square(&foot_violation(foot.bound, p_k, slip)));
        }
        largest.accumulate(squares.sqrt());
        // contacts
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(z.contacts()) {
            let gap = row
                .gap_velocity(&z.v, z.pusher_yield)
                .add_mul(ncp.compliance, *p_n);
            largest.accumulate(p_n.min(gap));
            let mut slip = Lanes::ZERO;
            // the slip of a contact that is open and carries nothing enters no row
            if ((p_n.abs() + p_t.abs()).gt(Lanes::ZERO) | gap.lt(Lanes::ZERO)).any() {
                slip = row.slip_velocity(&z.v, z.pusher_yield);
                largest.accumulate(friction_violation(row, slip, [*p_n, *p_t]));
            }
            self.contacts.push(ContactVelocity { gap, slip });
        }
        largest.value()
    }

    /// Copies one lane of `ncp` into lane `slot` of `to`, a map of `contacts` contacts, without the
    /// rows that pad it.
    #[inline(always)]
    pub fn pack_lane<const V: usize>(
        &self,
        ncp: &Ncp<W>,
        lane: usize,
        to: &mut NaturalMap<V>,
        contacts: usize,
        slot: usize,
    ) {
        for k in 0..3 {
            to.imbalance[k].0[slot] = self.imbalance[k].0[lane];
            to.slips[k][0].0[slot] = self.slips[k][0].0[lane];
            to.slips[k][1].0[slot] = self.slips[k][1].0[lane];
        }
        to.slack.0[slot] = self.slack.0[lane];
        to.contacts.resize(contacts, ContactVelocity::PADDING);
        let mut packed = 0;
        for (from, row) in self.contacts.iter().zip(&ncp.contacts) {
            if row.is_present(lane) {
                from.copy_lane(lane, &mut to.contacts[packed], slot);
                packed += 1;
            }
        }
        for beyond in &mut to.contacts[packed..] {
            ContactVelocity::<1>::PADDING.copy_lane(0, beyond, slot);
        }
    }
}

impl<const W: usize> ContactVelocity<W> {
    /// Of a row that only pads.
    const PADDING: Self = Self {
        gap: ContactRow::<W>::OPEN.gap_offset,
        slip: Lanes::ZERO,
    };

    #[inline(always)]
    fn copy_lane<const V: usize>(&self, lane: usize, to: &mut ContactVelocity<V>, slot: usize) {
        to.gap.0[slot] = self.gap.0[lane];
        to.slip.0[slot] = self.slip.0[lane];
    }
}

/// Π(p − s) − p of a foot.
#[inline(always)]
fn foot_violation<const W: usize>(
    bound: Lanes<W>,
    p: &[Lanes<W>; 2],
    slip: &[Lanes<W>; 2],
) -> [Lanes<W>; 2] {
    let trial = [p[0] - slip[0], p[1] - slip[1]];
    let size = square(&trial);
    let slides = size.gt(bound * bound);
    // a root only where some foot slides
    if !slides.any() {
        return [-slip[0], -slip[1]];
    }
    let shrink = bound * size.inverse_sqrt();
    [
        slides.select((-p[0]).add_mul(shrink, trial[0]), -slip[0]),
        slides.select((-p[1]).add_mul(shrink, trial[1]), -slip[1]),
    ]
}

/// The friction row of a contact: p_t − clamp(p_t − s, ±μ p_n).
#[inline(always)]
fn friction_violation<const W: usize>(
    row: &ContactRow<W>,
    slip: Lanes<W>,
    [p_n, p_t]: [Lanes<W>; 2],
) -> Lanes<W> {
    let bound = row.mu * p_n.max(Lanes::ZERO);
    p_t - (p_t - slip).min(bound).max(-bound)
}

impl<const W: usize> Ncp<W> {
    /// Certificate: lanes in which `z` with this residual counts as a solution.
    #[inline(always)]
    pub fn certifies(&self, z: &Unknowns<W>, residual: Lanes<W>) -> Mask<W> {
        !residual.gt(Lanes::splat(TOLERANCE)) & !z.fastest().gt(self.speed_limit())
    }

    /// The natural-map residual (m/s): the largest violation of any row of docs/method.md (16).
    pub fn residual(&self, z: &Unknowns<W>) -> Lanes<W> {
        NaturalMap::default().evaluate(self, z)
    }

    /// Velocity that follows from the impulses by the Newton–Euler rows, less the velocity in `z`.
    #[inline(always)]
    pub fn imbalance(&self, z: &Unknowns<W>) -> Triple<W> {
        let mut v = self.free;
        for (foot, p) in self.feet.iter().zip(&z.feet) {
            foot.add_wrench(&mut v, p);
        }
        for (row, (p_n, p_t)) in self.contacts.iter().zip(z.contacts()) {
            add_scaled(&mut v, &row.n, *p_n);
            add_scaled(&mut v, &row.t, *p_t);
        }
        [v[0] - z.v[0], v[1] - z.v[1], v[2] - z.v[2]]
    }

    /// F / m: the impulse with which the object resists the pusher along d.
    #[inline(always)]
    pub fn resistance(&self, z: &Unknowns<W>) -> Lanes<W> {
        let mut force = Lanes::ZERO;
        for (row, (p_n, p_t)) in self.contacts.iter().zip(z.contacts()) {
            force = force.add_mul(*p_n, row.nd).add_mul(*p_t, row.td);
        }
        force
    }
}
