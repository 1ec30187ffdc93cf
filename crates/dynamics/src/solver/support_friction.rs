//! The object on its feet alone: [`SupportFriction`].

use stickslip_lanes::{Lanes, Level, on_widest};

use crate::ncp::rows::{FootRow, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::solver::newton::{Newton, NewtonSettings};
use crate::solver::scalar_ncp::ScalarFoot;
use crate::solver::smoothed_path::{CAREFUL, SmoothedPath, SmoothingSchedule};
use crate::solver::stick_predictor::SLIP_WEIGHT_NEAR;
use crate::solver::vector::Vector;

/// Of the Newton iteration.
const SETTINGS: NewtonSettings = NewtonSettings {
    tolerance: 1e-13,
    iterations: 12,
    slip_weight: SLIP_WEIGHT_NEAR,
};

/// Feet alone make a convex problem, whose path seldom needs care.
const QUICK: SmoothingSchedule = SmoothingSchedule {
    start: 1e-1,
    reduction: 0.01,
    near: 1e3,
    steps: 30.0,
};

/// The map from a load to the velocity it causes where only the feet resist, with its working
/// memory: a search over curves evaluates it many times.
pub struct SupportFriction {
    ncp: Ncp<1>,
    start: Unknowns<1>,
    z: Unknowns<1>,
    newton: Newton<1>,
    path: SmoothedPath<1>,
    level: Level,
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
            start: Unknowns::default(),
            z: Unknowns::default(),
            newton: Newton::default(),
            path: SmoothedPath::default(),
            level: Level::new(),
        }
    }

    /// Velocity v = T⁻¹(load) and foot impulses, where `load` is the velocity without friction.
    ///
    /// v is the unique minimiser of ½|v − load|² + Σ bound_k |J_k v|, and 1-Lipschitz in the load.
    pub fn solve(&mut self, load: &Vector<3>) -> Moved {
        self.ncp.free = load.map(|x| Lanes([x]));
        // from the last velocity, then along paths from the free motion
        let (mut residual, mut systems) = self.iterate();
        for schedule in [&QUICK, &CAREFUL] {
            if residual <= SETTINGS.tolerance {
                break;
            }
            systems += self.follow(schedule);
            let iterations;
            (residual, iterations) = self.iterate();
            systems += iterations;
        }
        Moved {
            v: self.z.v.map(|x| x.0[0]),
            feet: self.z.feet.map(|f| f.map(|x| x.0[0])),
            residual,
            systems,
        }
    }

    /// Newton iterations from the present point: the residual then, and how many.
    fn iterate(&mut self) -> (f64, u32) {
        let end = on_widest(
            self.level,
            #[inline(always)]
            || self.newton.solve(&self.ncp, &mut self.z, SETTINGS),
        );
        (end.residual.0[0], end.iterations.0[0] as u32)
    }

    /// Moves to the end of a path of smoothed solutions from the free motion; the steps.
    fn follow(&mut self, schedule: &SmoothingSchedule) -> u32 {
        self.start.cold_start(&self.ncp);
        let (ncp, start, z) = (&self.ncp, &self.start, &mut self.z);
        self.path.solve_one(self.level, ncp, start, schedule, z).1
    }
}

/// How the object moves on its feet.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Its velocity.
    pub v: Vector<3>,
    /// Impulse of each foot.
    pub feet: [[f64; 2]; 3],
    /// Residual of the feet's rows (m/s).
    pub residual: f64,
    /// Linear systems solved.
    pub systems: u32,
}
