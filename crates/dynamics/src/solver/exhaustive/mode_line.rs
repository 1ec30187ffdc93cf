//! The velocities that three generators allow: [`ModeLine`].

use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::{Inequality, ModeConditions};
use crate::solver::exhaustive::piece_search::{ModePath, Sample};
use crate::solver::exhaustive::scalar_ncp::Candidate;
use crate::solver::exhaustive::subspace::{Equation, independence, least_squares, null_vector};
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

    /// Of the three equations among four that depend on each other least.
    pub fn of_dependent(equations: &[Equation; 4]) -> Option<Self> {
        let three = |skip: usize| [0, 1, 2].map(|k| equations[k + usize::from(k >= skip)]);
        let independence = |skip: &usize| independence(&three(*skip).map(|e| e.row));
        let skip = (0..4).max_by(|a, b| independence(a).total_cmp(&independence(b)))?;
        Self::new(&three(skip))
    }

    /// V at x.
    pub fn at(&self, x: f64) -> Vector<4> {
        add_scaled(&self.origin, x, &self.d)
    }

    /// Removes the part of an interval of x that violates an inequality by more than `slack`.
    pub fn clip(&self, interval: &mut Interval, inequality: &Inequality, slack: f64) {
        let Inequality { row, offset } = inequality;
        interval.clip(dot(row, &self.d), dot(row, &self.origin) + offset + slack);
    }

    /// The part of it where a mode's inequalities hold.
    pub fn interval(&self, conditions: &ModeConditions, chosen: &[Generator]) -> Interval {
        let mut interval = Interval {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        for inequality in conditions.inequalities(chosen) {
            self.clip(&mut interval, &inequality, conditions.slack);
        }
        interval
    }

    /// The part of it where, too, the friction of the feet can balance along m, in which no
    /// generator of the mode pushes.
    pub fn balanced_interval(
        &self,
        conditions: &ModeConditions,
        chosen: &[Generator],
        m: &Vector<4>,
    ) -> Interval {
        let mut interval = self.interval(conditions, chosen);
        let bound = conditions.friction_bound(&velocity(m)) + conditions.slack;
        let at_origin = conditions.load_along(m, &self.origin);
        let slope = dot(&velocity(m), &velocity(&self.d));
        interval.clip(slope, at_origin + bound);
        interval.clip(-slope, -at_origin + bound);
        interval
    }
}

/// A line on which impulses α ≥ 0 of three generators are to balance the load, with nothing left
/// along m.
pub struct ModeLine<'a> {
    conditions: &'a ModeConditions,
    chosen: &'a [Generator; 3],
    line: Line,
    /// Of the three generators and the direction m in which none of them pushes.
    dual: [Vector<4>; 4],
}

impl<'a> ModeLine<'a> {
    /// Of a line where the generators' equations hold.
    pub fn new(
        conditions: &'a ModeConditions,
        chosen: &'a [Generator; 3],
        line: Line,
        dual: [Vector<4>; 4],
    ) -> Self {
        Self {
            conditions,
            chosen,
            line,
            dual,
        }
    }
}

impl ModePath for ModeLine<'_> {
    fn sample(&mut self, x: f64) -> Sample {
        let v = self.line.at(x);
        let along_m = self.conditions.range_along(&self.dual[3], &v, &v);
        Sample {
            x,
            v,
            feet: self.conditions.problem.sliding_feet(&v),
            miss: along_m.midpoint(),
            error: 0.0,
            systems: 1,
        }
    }

    fn excludes(&self, a: &Sample, b: &Sample) -> bool {
        let slack = self.conditions.slack;
        let [i, j, k, along_m] = self
            .dual
            .map(|w| self.conditions.range_along(&w, &a.v, &b.v));
        let balances = along_m.low <= slack && along_m.high >= -slack;
        !balances || !self.conditions.allows(&[i, j, k])
    }

    fn balanced(&self) -> Option<(&ModeConditions, &[Generator])> {
        Some((self.conditions, self.chosen))
    }

    fn candidate(&self, at: &Sample) -> Candidate {
        let [i, j, k, _] = self.dual;
        let alpha = [i, j, k].map(|w| {
            let range = self.conditions.range_along(&w, &at.v, &at.v);
            range.midpoint()
        });
        self.conditions.candidate(self.chosen, &alpha, at.v)
    }
}
