//! The velocities that three generators allow: [`ModeLine`].

use crate::solver::generator::Generator;
use crate::solver::interval::Interval;
use crate::solver::mode_conditions::{Inequality, ModeConditions};
use crate::solver::piece_search::{ModePath, Sample};
use crate::solver::scalar_ncp::Candidate;
use crate::solver::subspace::{Equation, dual_basis, least_squares, null_vector};
use crate::solver::vector::{Vector, add_scaled, dot, velocity};

/// V = origin + x d, where the equations of three generators hold.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    origin: Vector<4>,
    d: Vector<4>,
}

impl Line {
    /// `None` where the equations depend on each other.
    pub fn new(equations: &[Equation; 3]) -> Option<Self> {
        Some(Self {
            d: null_vector(&equations.map(|e| e.row))?,
            origin: least_squares(equations),
        })
    }

    /// The part of it where a mode's inequalities hold.
    pub fn interval(&self, conditions: &ModeConditions, chosen: &[Generator; 3]) -> Interval {
        let mut interval = Interval {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        for Inequality { row, offset } in conditions.inequalities(chosen) {
            let at_origin = dot(&row, &self.origin) + offset + conditions.slack;
            interval.clip(dot(&row, &self.d), at_origin);
        }
        interval
    }
}

/// What three generators can balance of a load, and the direction m in which none of them pushes.
pub struct LineBalance {
    m: Vector<4>,
    /// Of the three generators and m.
    dual: [Vector<4>; 4],
}

impl LineBalance {
    /// `None` where the generators depend on each other.
    pub fn new(chosen: &[Generator; 3]) -> Option<Self> {
        let [a, b, c] = chosen.map(|generator| generator.g);
        let m = null_vector(&[a, b, c])?;
        Some(Self {
            m,
            dual: dual_basis(&[a, b, c, m])?,
        })
    }
}

/// A line on which impulses α ≥ 0 of three generators are to balance the load, with nothing left
/// along m.
pub struct ModeLine<'a> {
    conditions: &'a ModeConditions,
    chosen: &'a [Generator; 3],
    line: Line,
    balance: LineBalance,
}

impl<'a> ModeLine<'a> {
    /// Of a line where the generators' equations hold.
    pub fn new(
        conditions: &'a ModeConditions,
        chosen: &'a [Generator; 3],
        line: Line,
        balance: LineBalance,
    ) -> Self {
        Self {
            conditions,
            chosen,
            line,
            balance,
        }
    }

    /// The part of the line where the inequalities hold and the friction of the feet can balance
    /// along m.
    pub fn interval(&self) -> Interval {
        let (conditions, Line { origin, d }) = (self.conditions, &self.line);
        let mut interval = self.line.interval(conditions, self.chosen);
        let bound = conditions.friction_bound(&velocity(&self.balance.m)) + conditions.slack;
        let at_origin = conditions.load_along(&self.balance.m, origin);
        let slope = dot(&velocity(&self.balance.m), &velocity(d));
        interval.clip(slope, at_origin + bound);
        interval.clip(-slope, -at_origin + bound);
        interval
    }
}

impl ModePath for ModeLine<'_> {
    fn sample(&mut self, x: f64) -> Sample {
        let v = add_scaled(&self.line.origin, x, &self.line.d);
        let along_m = self.conditions.range_along(&self.balance.dual[3], &v, &v);
        Sample {
            x,
            v,
            feet: self.conditions.sliding_feet(&v),
            miss: along_m.midpoint(),
            error: 0.0,
            systems: 1,
        }
    }

    fn excludes(&self, a: &Sample, b: &Sample) -> bool {
        let slack = self.conditions.slack;
        let [i, j, k, along_m] = self
            .balance
            .dual
            .map(|w| self.conditions.range_along(&w, &a.v, &b.v));
        let balances = along_m.low <= slack && along_m.high >= -slack;
        !balances || [i, j, k].iter().any(|range| range.high < -slack)
    }

    fn candidate(&self, at: &Sample) -> Candidate {
        let [i, j, k, _] = self.balance.dual;
        let alpha = [i, j, k].map(|w| {
            let range = self.conditions.range_along(&w, &at.v, &at.v);
            range.midpoint()
        });
        self.conditions.candidate(self.chosen, &alpha, at.v)
    }
}
