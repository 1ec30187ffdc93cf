//! The velocities that two generators allow: [`ModeCurve`].

use crate::solver::generator::Generator;
use crate::solver::interval::Interval;
use crate::solver::mode_conditions::ModeConditions;
use crate::solver::subspace::Equation;
use crate::solver::vector::{Vector, add_scaled, dot, norm, velocity};

/// The curve v(λ) = T⁻¹(`load_0` + λ `load`), λ the impulse of one generator; the fourth balance
/// ties the impulse of the other one to it, `ratio` λ + `constant`. Of the two equations, one gives
/// y, and w·v + `offset` = 0 is the other one with y eliminated.
pub struct ModeCurve {
    /// Load at λ = 0.
    pub load_0: Vector<3>,
    /// Change of the load with λ.
    pub load: Vector<3>,
    /// Coefficients of the equation to solve.
    pub w: Vector<3>,
    /// Its constant.
    pub offset: f64,
    ratio: f64,
    constant: f64,
    tied_is_first: bool,
    gives_y: Equation,
}

impl ModeCurve {
    /// Of two generators; `None` where neither impulse is tied to the other, or y is not
    /// determined.
    pub fn new(conditions: &ModeConditions, chosen: &[Generator; 2]) -> Option<Self> {
        let problem = &conditions.problem;
        let tied_is_first = chosen[0].g[3].abs() > chosen[1].g[3].abs();
        let (free, tied) = if tied_is_first {
            (chosen[1], chosen[0])
        } else {
            (chosen[0], chosen[1])
        };
        let [e0, e1] = conditions.equations(chosen);
        let (gives_y, solve) = if e0.row[3].abs() > e1.row[3].abs() {
            (e0, e1)
        } else {
            (e1, e0)
        };
        if tied.g[3] == 0.0 || gives_y.row[3] == 0.0 {
            return None;
        }
        let (ratio, constant) = (-free.g[3] / tied.g[3], problem.stall / tied.g[3]);
        let k = solve.row[3] / gives_y.row[3];
        Some(Self {
            load_0: add_scaled(&problem.free, constant, &velocity(&tied.g)),
            load: add_scaled(&velocity(&free.g), ratio, &velocity(&tied.g)),
            w: add_scaled(&velocity(&solve.row), -k, &velocity(&gives_y.row)),
            offset: k * gives_y.value - solve.value,
            ratio,
            constant,
            tied_is_first,
            gives_y,
        })
    }

    /// The λ for which both impulses are positive and the feet's friction can balance the load.
    pub fn interval(&self, conditions: &ModeConditions) -> Interval {
        let mut interval = Interval {
            low: 0.0,
            high: f64::INFINITY,
        };
        interval.clip(self.ratio, self.constant + conditions.slack);
        let bound = conditions.friction_bound(&self.w) + conditions.slack;
        let (slope, at_0) = (dot(&self.w, &self.load), dot(&self.w, &self.load_0));
        interval.clip(slope, at_0 + self.offset + bound);
        interval.clip(-slope, -at_0 - self.offset + bound);
        interval
    }

    /// The impulses of both generators.
    pub fn impulses(&self, lambda: f64) -> [f64; 2] {
        let tied = self.ratio * lambda + self.constant;
        if self.tied_is_first {
            [tied, lambda]
        } else {
            [lambda, tied]
        }
    }

    /// The pusher's yield that belongs to v.
    pub fn pusher_yield(&self, v: &Vector<3>) -> f64 {
        (self.gives_y.value - dot(&velocity(&self.gives_y.row), v)) / self.gives_y.row[3]
    }

    /// Most that the yield changes per change of v.
    pub fn yield_gain(&self) -> f64 {
        norm(&velocity(&self.gives_y.row)) / self.gives_y.row[3].abs()
    }
}
