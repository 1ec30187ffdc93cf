//! The object on its feet alone: [`SupportFriction`].

use stickslip_lanes::Lanes;

use crate::ncp::rows::{FootRow, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::solver::homotopy::Homotopy;
use crate::solver::newton::{Newton, NewtonSettings};
use crate::solver::scalar_ncp::ScalarFoot;
use crate::solver::vector::Vector;

/// Of the Newton iteration, far from a solution.
const SETTINGS: NewtonSettings = NewtonSettings {
    tolerance: 1e-11,
    iterations: 12,
    slip_weight: 1.0,
};

/// The map from a load to the velocity it causes where only the feet resist, with its working
/// memory: a search over curves evaluates it many times.
pub struct SupportFriction {
    ncp: Ncp<1>,
    z: Unknowns<1>,
    newton: Newton<1>,
    homotopy: Homotopy,
}

impl SupportFriction {
    /// Of these feet.
    pub fn new(feet: &[ScalarFoot; 3]) -> Self {
        let row = |foot: ScalarFoot| FootRow {
            jx: Lanes([foot.jx]),
            jy: Lanes([foot.jy]),
            bound: Lanes([foot.bound]),
        };
        Self {
            ncp: Ncp {
                feet: feet.map(row),
                ..Ncp::default()
            },
            z: Unknowns::default(),
            newton: Newton::default(),
            homotopy: Homotopy::default(),
        }
    }

    /// Velocity v = T⁻¹(load) and foot impulses, where `load` is the velocity without friction.
    ///
    /// v is the unique minimiser of ½|v − load|² + Σ bound_k |J_k v|, and 1-Lipschitz in the load.
    pub fn solve(&mut self, load: &Vector<3>) -> (Vector<3>, [[f64; 2]; 3]) {
        self.ncp.free = load.map(|x| Lanes([x]));
        self.z.cold_start(&self.ncp);
        let residual = self.newton.solve(&self.ncp, &mut self.z, SETTINGS);
        if residual.0[0] > SETTINGS.tolerance {
            self.z.cold_start(&self.ncp);
            self.z
                .copy_from(self.homotopy.follow(&self.ncp, &self.z, 1.0));
            self.newton.solve(&self.ncp, &mut self.z, SETTINGS);
        }
        (
            self.z.v.map(|x| x.0[0]),
            self.z.feet.map(|f| f.map(|x| x.0[0])),
        )
    }
}
