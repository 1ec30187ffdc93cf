//! The solution with compliant gap rows, where the rigid problem has none: [`CompliantNewton`].
//!
//! Where the compliance κ is large, contacts carry little and the solution is near the free motion;
//! from there κ falls step by step, and every solution is the start of the next.

use stickslip_lanes::{Lanes, Level, on_fused};

use crate::ncp::report::TOLERANCE;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::newton::{Newton, NewtonSettings};
use crate::solver::smoothed_path::{BOLD, CAREFUL, SmoothedPath};
use crate::solver::stick_predictor::SLIP_WEIGHT_NEAR;

/// κ of docs/method.md (14).
const COMPLIANCE: f64 = 1e-6;

/// κ that is tried first, and the softest.
const FIRST: f64 = 1.0;
const SOFTEST: f64 = 1e4;

/// Factor by which κ falls at best, and the factor nearest to 1 that is tried where it falls with
/// difficulty before it jumps.
const REDUCTION: f64 = 0.1;
const LEAST_REDUCTION: f64 = 0.9;

/// Of the Newton iteration at one κ.
const SETTINGS: NewtonSettings = NewtonSettings {
    tolerance: 0.1 * TOLERANCE,
    iterations: 16,
    slip_weight: SLIP_WEIGHT_NEAR,
};

/// Residual per impulse that rounding leaves: impulses may be of a million metres per second here.
const ROUNDING: f64 = 1e-11;

/// The compliant solver with its working memory.
#[derive(Clone, Debug)]
pub struct CompliantNewton {
    /// The solution, or where there is none the last one of a softer problem.
    pub z: Unknowns<1>,
    ncp: Ncp<1>,
    cold: Unknowns<1>,
    trial: Unknowns<1>,
    newton: Newton<1>,
    path: SmoothedPath<1>,
    level: Level,
}

impl Default for CompliantNewton {
    fn default() -> Self {
        Self {
            z: Unknowns::default(),
            ncp: Ncp::default(),
            cold: Unknowns::default(),
            trial: Unknowns::default(),
            newton: Newton::default(),
            path: SmoothedPath::default(),
            level: Level::new(),
        }
    }
}

impl CompliantNewton {
    /// Leaves in `self.z` the solution of `ncp` with compliant gap rows, or of the stiffest ones
    /// that were solved within `limit` linear systems: the free motion, where none was.
    ///
    /// Returns the linear systems that it took; the last compliance may exceed the limit.
    pub fn solve(&mut self, ncp: &Ncp<1>, limit: u32) -> u32 {
        self.ncp.copy_from(ncp);
        self.cold.cold_start(ncp);
        self.z.copy_from(&self.cold);
        let (mut compliance, mut systems) = (FIRST, 0);
        let (mut reduction, mut jump) = (REDUCTION, 1.0);
        let mut solved_at = None;
        while systems < limit {
            self.ncp.compliance = Lanes([compliance]);
            if self.solve_at(&mut systems) {
                std::mem::swap(&mut self.z, &mut self.trial);
                solved_at = Some(compliance);
                (reduction, jump) = (f64::max(reduction * reduction, REDUCTION), 1.0);
            } else {
                reduction = reduction.sqrt();
            }
            compliance = match solved_at {
                Some(at) if at * jump <= COMPLIANCE => break,
                // the solutions turn back, and are found again farther on
                Some(at) if reduction > LEAST_REDUCTION => {
                    jump *= REDUCTION;
                    f64::max(at * jump, COMPLIANCE)
                }
                Some(at) => f64::max(at * reduction, COMPLIANCE),
                // softer ones are easier
                None if compliance < SOFTEST => compliance / REDUCTION,
                None => break,
            };
        }
        systems
    }

    /// Tries to solve the problem at its compliance, from the last solution, then along smoothed
    /// paths from there and from the free motion; leaves the result in `self.trial`.
    fn solve_at(&mut self, systems: &mut u32) -> bool {
        self.trial.copy_from(&self.z);
        let (ncp, trial, newton) = (&self.ncp, &mut self.trial, &mut self.newton);
        let end = on_fused(
            self.level,
            #[inline(always)]
            || newton.solve(ncp, trial, SETTINGS),
        );
        *systems += end.iterations.0[0] as u32;
        if is_solved(ncp, end.residual.0[0], trial) {
            return true;
        }
        for (start, schedule) in [(&self.z, &BOLD), (&self.cold, &CAREFUL)] {
            let path = &mut self.path;
            let (residual, steps) = path.solve_one(self.level, ncp, start, schedule, trial);
            *systems += steps;
            if is_solved(ncp, residual, trial) {
                return true;
            }
        }
        false
    }
}

/// Returns true if a residual is no more than the tolerance and what rounding leaves, at a speed
/// that a solution may have.
fn is_solved(ncp: &Ncp<1>, residual: f64, z: &Unknowns<1>) -> bool {
    let largest = z.largest_normal().0[0];
    residual <= TOLERANCE + ROUNDING * largest && z.fastest().0[0] <= ncp.speed_limit().0[0]
}
