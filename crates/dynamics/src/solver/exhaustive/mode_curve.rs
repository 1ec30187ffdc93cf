//! The velocities that two generators allow: [`ModeCurve`].

use crate::solver::exhaustive::enclosure::{Between, Enclosure, Slide};
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::{LARGEST, ModeConditions};
use crate::solver::exhaustive::piece_search::{ModePath, Sample};
use crate::solver::exhaustive::scalar_ncp::Candidate;
use crate::solver::exhaustive::subspace::Equation;
use crate::solver::exhaustive::support_friction::SupportFriction;
use crate::solver::vector::{Vector, add_scaled, dot, norm, velocity};

/// Error of a velocity from [`SupportFriction`] (m/s, relative where above 1), unless its residual
/// is larger.
const ROUNDING: f64 = 1e-13;

/// Times that an enclosure is made narrower by the slips that it leaves.
const NARROWER: u32 = 3;

/// The curve v(λ) = T⁻¹(`load_0` + λ `load`), λ the impulse of one generator; the fourth balance
/// ties the impulse of the other one to it, `ratio` λ + `constant`. Of the two equations, one gives
/// y, and w·v + `offset` = 0 is the other one with y eliminated.
pub struct ModeCurve<'a> {
    conditions: &'a ModeConditions,
    chosen: &'a [Generator; 2],
    support: SupportFriction,
    /// Load at λ = 0.
    load_0: Vector<3>,
    /// Change of the load with λ.
    load: Vector<3>,
    /// Coefficients of the equation to solve.
    w: Vector<3>,
    /// Its constant.
    offset: f64,
    ratio: f64,
    constant: f64,
    tied_is_first: bool,
    gives_y: Equation,
    /// Conditions at a solution: row·v + offset ≥ 0.
    limits: Vec<(Vector<3>, f64)>,
}

impl<'a> ModeCurve<'a> {
    /// Of two generators; `None` where neither impulse is tied to the other, or y is not
    /// determined.
    pub fn new(conditions: &'a ModeConditions, chosen: &'a [Generator; 2]) -> Option<Self> {
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
        let without_yield = |row: &Vector<4>, offset: f64| {
            let k = row[3] / gives_y.row[3];
            let row = add_scaled(&velocity(row), -k, &velocity(&gives_y.row));
            (row, offset + k * gives_y.value)
        };
        let (w, offset) = without_yield(&solve.row, -solve.value);
        let inequalities = conditions.inequalities(chosen);
        let limits = [(w, offset), (w.map(|x| -x), -offset)]
            .into_iter()
            .chain(inequalities.map(|it| without_yield(&it.row, it.offset)));
        Some(Self {
            limits: limits.collect(),
            conditions,
            chosen,
            support: SupportFriction::new(&problem.feet),
            load_0: add_scaled(&problem.free, constant, &velocity(&tied.g)),
            load: add_scaled(&velocity(&free.g), ratio, &velocity(&tied.g)),
            w,
            offset,
            ratio,
            constant,
            tied_is_first,
            gives_y,
        })
    }

    /// The λ for which both impulses are positive and not too large, and the feet's friction can
    /// balance the load.
    pub fn interval(&self) -> Interval {
        let conditions = self.conditions;
        let mut interval = Interval {
            low: 0.0,
            high: f64::INFINITY,
        };
        interval.clip(self.ratio, self.constant + conditions.slack);
        interval.clip(-self.ratio, LARGEST - self.constant);
        for (row, offset) in &self.limits {
            let most = offset + conditions.friction_bound(row) + conditions.slack;
            interval.clip(dot(row, &self.load), dot(row, &self.load_0) + most);
        }
        interval
    }

    /// The impulses of both generators.
    fn impulses(&self, lambda: f64) -> [f64; 2] {
        let tied = self.ratio * lambda + self.constant;
        if self.tied_is_first {
            [tied, lambda]
        } else {
            [lambda, tied]
        }
    }

    /// The pusher's yield that belongs to v.
    fn pusher_yield(&self, v: &Vector<3>) -> f64 {
        (self.gives_y.value - dot(&velocity(&self.gives_y.row), v)) / self.gives_y.row[3]
    }

    /// Returns true if no v of an enclosure meets all conditions.
    fn excludes_all(&self, enclosure: &Enclosure) -> bool {
        self.limits.iter().any(|(row, offset)| {
            let value = dot(row, &enclosure.centre) + offset + self.conditions.slack;
            value < 0.0 && value < -enclosure.reach(row)
        })
    }
}

impl ModePath for ModeCurve<'_> {
    fn sample(&mut self, x: f64) -> Sample {
        let moved = self.support.solve(&add_scaled(&self.load_0, x, &self.load));
        let [vx, vy, turn] = moved.v;
        Sample {
            x,
            v: [vx, vy, turn, self.pusher_yield(&moved.v)],
            feet: moved.feet,
            miss: dot(&self.w, &moved.v) + self.offset,
            error: f64::max(ROUNDING * (1.0 + norm(&moved.v)), moved.residual),
            systems: moved.systems,
        }
    }

    fn excludes(&self, a: &Sample, b: &Sample) -> bool {
        let ends = [a, b].map(|at| Slide {
            v: velocity(&at.v),
            feet: &at.feet,
        });
        let change = add_scaled(&ends[1].v, -1.0, &ends[0].v);
        let rounding = a.error.max(b.error);
        let along = dot(&self.load, &change).abs() + rounding * norm(&self.load);
        let between = Between {
            feet: &self.conditions.problem.feet,
            ends,
            power: (b.x - a.x) * along,
            rounding,
        };
        let mut enclosure = between.ball();
        for _ in 0..NARROWER {
            if self.excludes_all(&enclosure) {
                return true;
            }
            let Some(narrower) = between.narrower(&enclosure) else {
                return false;
            };
            enclosure = narrower;
        }
        self.excludes_all(&enclosure)
    }

    fn candidate(&self, at: &Sample) -> Candidate {
        let alpha = self.impulses(at.x);
        Candidate {
            feet: at.feet,
            ..self.conditions.candidate(self.chosen, &alpha, at.v)
        }
    }
}
