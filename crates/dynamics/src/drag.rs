//! The object on its feet alone: v = T⁻¹(load), the velocity that a load leads to when no contact acts.

use crate::Lanes;
use crate::homotopy::Homotopy;
use crate::impulses::Impulses;
use crate::ncp::{FootRow, Ncp};
use crate::newton::Newton;
use crate::rows::{Rows, Vector};

/// Velocity and foot impulses of the problem without contacts and with free velocity `load`.
///
/// It is the minimiser of ½|v − load|² + Σ bound_k |J_k v|, unique, and moves no farther than the load does.
pub fn drag(rows: &Rows, load: &Vector<3>) -> (Vector<3>, [[f64; 2]; 3]) {
    let mut ncp = Ncp::<1>::empty();
    ncp.free = load.map(|x| Lanes([x]));
    ncp.feet = rows.feet.map(|f| FootRow { jx: Lanes([f.jx]), jy: Lanes([f.jy]), bound: Lanes([f.bound]) });
    let mut p = Impulses { v: ncp.free, ..Impulses::zero(0) };
    let mut newton = Newton::default();
    let (residual, _) = newton.solve(&ncp, &mut p, 1e-11, 12);
    if residual.0[0] > 1e-11 {
        let start = Impulses { v: ncp.free, ..Impulses::zero(0) };
        p.copy_from(Homotopy::default().follow(&ncp, &start, 1.0));
        newton.solve(&ncp, &mut p, 1e-11, 12);
    }
    (p.v.map(|x| x.0[0]), p.feet.map(|f| f.map(|x| x.0[0])))
}
