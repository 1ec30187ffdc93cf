//! One lane of an assembled chunk as a problem in SI units, for oracles and observers.

use stickslip_lanes::Lanes;

use crate::assembly::{Assembly, Row, Scaling};
use crate::input::Body;
use crate::ncp::problem::{ContactPoint, Foot, StepProblem};
use crate::ncp::rows::{ContactRow, FootRow, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::se2::{Twist, Wrench};
use crate::solved_contact::SolvedContact;

impl<const W: usize> Assembly<W> {
    /// One lane's problem in SI units; the applied impulse is part of its twist.
    pub fn problem(&self, ncp: &Ncp<W>, lane: usize) -> StepProblem {
        let Scaling {
            mass,
            inertia,
            h,
            stall,
            ..
        } = self.scaling;
        let rho = self.rho();
        let [vx, vy, scaled] = ncp.free.map(|x| x.0[lane]);
        let foot = |row: &FootRow<W>| Foot {
            arm: [row.jy.0[lane] * rho, -row.jx.0[lane] * rho],
            bound: row.bound.0[lane] * mass,
        };
        let rows = self.rows.iter().zip(&ncp.contacts);
        let contacts = rows
            .filter(|(row, _)| row.present.lane(lane))
            .map(|(row, numbers)| self.contact_point(row, numbers, lane));
        StepProblem {
            mass,
            inertia,
            h,
            twist: Twist {
                vx,
                vy,
                omega: scaled / rho,
            },
            applied: Wrench::default(),
            contacts: contacts.collect(),
            feet: ncp.feet.each_ref().map(foot),
            stall,
        }
    }

    /// Visits the contacts of one lane after the step.
    pub fn each_contact(
        &self,
        ncp: &Ncp<W>,
        p: &Unknowns<W>,
        lane: usize,
        visit: &mut dyn FnMut(&SolvedContact),
    ) {
        let one = |x: Lanes<W>| Lanes([x.0[lane]]);
        let (v, pusher_yield) = (p.v.map(one), one(p.pusher_yield));
        let numbers = ncp.contacts.iter().zip(&p.normal);
        for (row, (numbers, impulse)) in self.rows.iter().zip(numbers) {
            if row.present.lane(lane) {
                // the lane alone: a whole chunk costs as many times, contact by contact
                let mut alone = ContactRow::<1>::OPEN;
                numbers.copy_lane(lane, &mut alone, 0);
                let gap = alone.gap_velocity(&v, pusher_yield).0[0] * self.scaling.h;
                visit(&SolvedContact {
                    body: row.body,
                    point: self.contact_point(row, numbers, lane),
                    impulse: impulse.0[lane] * self.scaling.mass,
                    gap,
                });
            }
        }
    }

    /// One lane of a contact in SI units.
    fn contact_point(&self, row: &Row<W>, numbers: &ContactRow<W>, lane: usize) -> ContactPoint {
        let (h, rho, gap) = (self.scaling.h, self.rho(), row.gap.0[lane]);
        let ([nx, ny, normal], [.., tangential]) =
            (numbers.n.map(|x| x.0[lane]), numbers.t.map(|x| x.0[lane]));
        let (approach, slip) = (
            gap / h - numbers.gap_offset.0[lane],
            -numbers.slip_offset.0[lane],
        );
        ContactPoint {
            normal: [nx, ny],
            arm: [
                (tangential * nx + normal * ny) * rho,
                (tangential * ny - normal * nx) * rho,
            ],
            gap,
            mu: numbers.mu.0[lane],
            surface_velocity: [nx * approach - ny * slip, ny * approach + nx * slip],
            yields: match row.body {
                Body::Finger(i) => Some(self.directions[i].map(|d| d.0[lane])),
                Body::Fixel(_) => None,
            },
        }
    }

    fn rho(&self) -> f64 {
        (self.scaling.inertia / self.scaling.mass).sqrt()
    }
}
