//! State of the contact with one body after a step: impulse, gap and slip.

use stickslip_lanes::Lanes;

use crate::assembly::Assembly;
use crate::input::Body;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;

impl<const W: usize> Assembly<W> {
    /// Normal impulses (N s) of one body.
    #[inline(always)]
    pub fn normal_impulses(&self, p: &Unknowns<W>, body: Body) -> Lanes<W> {
        let mut sum = Lanes::ZERO;
        for (row, p_n) in self.rows.iter().zip(&p.normal) {
            if row.body == body {
                sum += *p_n;
            }
        }
        sum * self.scaling.mass
    }

    /// Impulse (N s) of the table's friction on the object, x and y in the world.
    #[inline(always)]
    pub fn support_impulses(&self, p: &Unknowns<W>) -> [Lanes<W>; 2] {
        let [a, b, c] = &p.feet;
        [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) * self.scaling.mass)
    }

    /// Smallest gap (m) to one body after the step; infinite where there is no contact.
    #[inline(always)]
    pub fn gaps(&self, ncp: &Ncp<W>, p: &Unknowns<W>, body: Body) -> Lanes<W> {
        let far = Lanes::splat(f64::INFINITY);
        let mut smallest = far;
        for (row, contact) in self.rows.iter().zip(&ncp.contacts) {
            if row.body == body {
                let gap = contact.gap_velocity(&p.v, p.pusher_yield) * self.scaling.h;
                smallest = smallest.min(row.present.select(gap, far));
            }
        }
        smallest
    }

    /// Slip velocity (m/s) at one body: the mean over its contacts, each weighted by its normal
    /// impulse. Where none presses, it is that of the nearest contact, and 0 where there is no
    /// contact.
    #[inline(always)]
    pub fn slips(&self, ncp: &Ncp<W>, p: &Unknowns<W>, body: Body) -> Lanes<W> {
        let (mut pressed, mut pressed_slip) = (Lanes::ZERO, Lanes::ZERO);
        let (mut nearest, mut nearest_slip) = (Lanes::splat(f64::INFINITY), Lanes::ZERO);
        let rows = self.rows.iter().zip(&ncp.contacts).zip(&p.normal);
        for ((row, contact), p_n) in rows {
            if row.body == body {
                let slip = contact.slip_velocity(&p.v, p.pusher_yield);
                pressed += *p_n;
                pressed_slip += *p_n * slip;
                let gap = contact.gap_velocity(&p.v, p.pusher_yield);
                let nearer = row.present & gap.lt(nearest);
                nearest = nearer.select(gap, nearest);
                nearest_slip = nearer.select(slip, nearest_slip);
            }
        }
        let presses = pressed.gt(Lanes::ZERO);
        presses.select(
            pressed_slip / presses.select(pressed, Lanes::splat(1.0)),
            nearest_slip,
        )
    }
}
