//! The object on its feet alone: v = T⁻¹(load), the velocity that a load leads to when no contact
//! acts.

use stickslip_lanes::Lanes;

use crate::ncp::rows::{FootRow, Ncp};
use crate::ncp::unknowns::Impulses;
use crate::solver::mode_rows::{Foot, Vector};
use crate::solver::newton::{Goal, Newton};
use crate::solver::path::Homotopy;

/// What the fast solver tries.
const GOAL: Goal = Goal {
    residual: 1e-11,
    iterations: 12,
    weight: 1.0,
};

/// The problem without contacts, with its working memory: a search over curves solves it many
/// times.
pub struct Drag {
    ncp: Ncp<1>,
    p: Impulses<1>,
    newton: Newton<1>,
    homotopy: Homotopy,
}

impl Drag {
    /// On these feet.
    pub fn on(feet: &[Foot; 3]) -> Self {
        let mut ncp = Ncp::empty();
        ncp.feet = feet.map(|f| FootRow {
            jx: Lanes([f.jx]),
            jy: Lanes([f.jy]),
            bound: Lanes([f.bound]),
        });
        Self {
            ncp,
            p: Impulses::zero(0),
            newton: Newton::default(),
            homotopy: Homotopy::default(),
        }
    }

    /// Velocity and foot impulses with free velocity `load`.
    ///
    /// It is the minimiser of ½|v − load|² + Σ bound_k |J_k v|, unique, and moves no farther than
    /// the load does.
    pub fn under(&mut self, load: &Vector<3>) -> (Vector<3>, [[f64; 2]; 3]) {
        self.ncp.free = load.map(|x| Lanes([x]));
        self.p.cold_start(&self.ncp);
        let residual = self.newton.solve(&self.ncp, &mut self.p, GOAL);
        if residual.0[0] > GOAL.residual {
            self.p.cold_start(&self.ncp);
            self.p
                .copy_from(self.homotopy.follow(&self.ncp, &self.p, 1.0));
            self.newton.solve(&self.ncp, &mut self.p, GOAL);
        }
        (
            self.p.v.map(|x| x.0[0]),
            self.p.feet.map(|f| f.map(|x| x.0[0])),
        )
    }
}
