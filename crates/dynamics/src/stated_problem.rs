//! One lane of an assembled chunk as a problem in SI units, for oracles and observers.

use crate::assembly::{Assembly, Scaling};
use crate::input::Body;
use crate::ncp::problem::{ContactPoint, Foot, StepProblem};
use crate::ncp::rows::{FootRow, Ncp};
use crate::se2::{Twist, Wrench};

impl<const W: usize> Assembly<W> {
    /// The body of each contact of one lane, in the order of its problem.
    pub fn bodies(&self, lane: usize) -> Vec<Body> {
        self.rows
            .iter()
            .filter(|row| row.present.lane(lane))
            .map(|row| row.body)
            .collect()
    }

    /// One lane's problem in SI units; the applied impulse is part of its twist.
    pub fn problem(&self, ncp: &Ncp<W>, lane: usize) -> StepProblem {
        let Scaling {
            mass,
            inertia,
            h,
            stall,
            ..
        } = self.scaling;
        let rho = (inertia / mass).sqrt();
        let [vx, vy, scaled] = ncp.free.map(|x| x.0[lane]);
        let foot = |row: &FootRow<W>| Foot {
            arm: [row.jy.0[lane] * rho, -row.jx.0[lane] * rho],
            bound: row.bound.0[lane] * mass,
        };
        let rows = self
            .rows
            .iter()
            .zip(&ncp.contacts)
            .filter(|(row, _)| row.present.lane(lane));
        let contacts = rows.map(|(row, numbers)| {
            let gap = row.gap.0[lane];
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
        });
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
}
