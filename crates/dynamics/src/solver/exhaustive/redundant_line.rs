//! The velocities that four generators allow whose equations depend on each other:
//! [`RedundantLine`].

use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::ModeConditions;
use crate::solver::exhaustive::mode_line::Line;
use crate::solver::exhaustive::piece_search::{ModePath, Sample};
use crate::solver::exhaustive::scalar_ncp::Candidate;
use crate::solver::vector::Vector;

/// A line on which impulses α ≥ 0 of four generators balance the load: three points of a face on
/// another one, or a disc between parallel walls, whose gaps close together.
///
/// Any V of it has its impulses; a solution is where none of them is negative.
pub struct RedundantLine<'a> {
    conditions: &'a ModeConditions,
    chosen: &'a [Generator; 4],
    line: Line,
    /// Of the generators.
    dual: [Vector<4>; 4],
}

impl<'a> RedundantLine<'a> {
    /// Of the line that three of the equations leave, and the generators' dual basis.
    pub fn new(
        conditions: &'a ModeConditions,
        chosen: &'a [Generator; 4],
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

    /// The part of the line where all equations and inequalities hold, and the friction of the feet
    /// can balance the rest that the impulses leave.
    pub fn interval(&self) -> Interval {
        let conditions = self.conditions;
        let mut interval = self.line.interval(conditions, self.chosen);
        let impulses = self.dual.iter().map(|w| conditions.most_along(w));
        for inequality in conditions
            .both_sides(self.chosen)
            .into_iter()
            .chain(impulses)
        {
            self.line.clip(&mut interval, &inequality, conditions.slack);
        }
        interval
    }

    fn impulses(&self, v: &Vector<4>) -> [f64; 4] {
        self.dual
            .map(|w| self.conditions.range_along(&w, v, v).midpoint())
    }
}

impl ModePath for RedundantLine<'_> {
    fn sample(&mut self, x: f64) -> Sample {
        let v = self.line.at(x);
        Sample {
            x,
            v,
            feet: self.conditions.problem.sliding_feet(&v),
            // the most negative impulse, if any is
            miss: self.impulses(&v).into_iter().fold(0.0, f64::min),
            error: 0.0,
            systems: 1,
        }
    }

    fn excludes(&self, a: &Sample, b: &Sample) -> bool {
        let range = |w: Vector<4>| self.conditions.range_along(&w, &a.v, &b.v);
        !self.conditions.allows(&self.dual.map(range))
    }

    fn balanced(&self) -> Option<(&ModeConditions, &[Generator])> {
        Some((self.conditions, self.chosen))
    }

    fn candidate(&self, at: &Sample) -> Candidate {
        let alpha = self.impulses(&at.v);
        self.conditions.candidate(self.chosen, &alpha, at.v)
    }
}
