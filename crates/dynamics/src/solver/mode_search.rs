//! Exhaustive search over contact modes: [`search`] finds a solution or proves that there is none.
//!
//! With V = (v, y) and T(V) = (v − v_free − Σ J_kᵀ p_k(v), F_stall h / m), a solution is a V and
//! impulses α ≥ 0 with Σ α g = T(V), where the *generators* g are the two edges n ± μ t of every
//! closed contact's friction cone and the unit vector of the stall pair. By Carathéodory's theorem
//! at most four linearly independent generators suffice. Each generator demands that its own row of
//! V vanish (gap velocity, slip velocity where both edges of a contact are used, y for the stall
//! pair), so a subset of four leaves a point, of three a line, of two a curve v(λ) = T⁻¹(…), of one
//! again a point. Lines and curves are searched by interval bisection with bounds that hold
//! rigorously on every piece: pieces without a solution are discarded, what remains is handed to
//! `accept`. Where nothing remains, there is no solution.

use crate::solver::bisection::{Accept, Finding, Piece, bisect};
use crate::solver::elimination::solve_dense;
use crate::solver::generator::Generator;
use crate::solver::interval::Interval;
use crate::solver::mode_conditions::{Inequality, ModeConditions};
use crate::solver::mode_curve::ModeCurve;
use crate::solver::scalar_ncp::{Candidate, ScalarNcp};
use crate::solver::subspace::{DEPENDENT, dual_basis, least_squares, null_vector};
use crate::solver::support_friction::SupportFriction;
use crate::solver::vector::{Vector, add_scaled, dot, norm, velocity};

/// How the search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// `accept` took a candidate.
    Solved,
    /// Every mode was excluded: the problem has no solution.
    Infeasible,
    /// Some piece of some mode could be neither excluded nor accepted.
    Unresolved,
}

/// Sizes of subsets in the order in which they are searched: points and lines cost a few products,
/// every piece of a curve a problem of its own.
const CHEAPEST_FIRST: [usize; 4] = [4, 1, 3, 2];

/// Pieces of a line or curve examined before it counts as unclear, in a first and a second round.
const MAX_PIECES: [usize; 2] = [2_000, 50_000];

/// End of lines and curves (m/s): no impulse or speed is so large.
const FARTHEST: f64 = 1e6;

/// Searches all modes, and again with more pieces where something was unclear.
pub fn search(problem: &ScalarNcp, accept: &mut Accept<'_>) -> Verdict {
    let mut verdict = Verdict::Unresolved;
    for max_pieces in MAX_PIECES {
        verdict = ModeSearch::new(problem, max_pieces).run(accept);
        if verdict != Verdict::Unresolved {
            break;
        }
    }
    verdict
}

/// All index sets of `size` out of `n`, in lexical order.
fn subsets(n: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let tails = |first: usize| {
        subsets(n - first - 1, size - 1)
            .into_iter()
            .map(move |tail| {
                std::iter::once(first)
                    .chain(tail.into_iter().map(|i| i + first + 1))
                    .collect()
            })
    };
    (0..n).flat_map(tails).collect()
}

/// The search of one problem.
struct ModeSearch {
    conditions: ModeConditions,
    generators: Vec<Generator>,
    rigid: bool,
    max_pieces: usize,
}

impl ModeSearch {
    fn new(problem: &ScalarNcp, max_pieces: usize) -> Self {
        let rigid = !problem.stall.is_finite();
        let mut problem = problem.clone();
        if rigid {
            // the yield then has no effect and the fourth balance reads 0 = 0
            problem.stall = 0.0;
            for c in &mut problem.contacts {
                (c.n[3], c.t[3]) = (0.0, 0.0);
            }
        }
        Self {
            generators: Generator::all(&problem),
            conditions: ModeConditions::new(problem),
            rigid,
            max_pieces,
        }
    }

    /// Examines all subsets of generators until one has a solution.
    fn run(&self, accept: &mut Accept<'_>) -> Verdict {
        let mut verdict = Verdict::Infeasible;
        for size in CHEAPEST_FIRST {
            for subset in subsets(self.generators.len(), size) {
                let chosen: Vec<Generator> = subset.iter().map(|i| self.generators[*i]).collect();
                match self.examine(&chosen, accept) {
                    Finding::Solved => return Verdict::Solved,
                    Finding::Unclear => verdict = Verdict::Unresolved,
                    Finding::Excluded => {}
                }
            }
        }
        verdict
    }

    fn examine(&self, chosen: &[Generator], accept: &mut Accept<'_>) -> Finding {
        // a rigid pusher does not yield: its stall pair is always among them
        if self.rigid && chosen[0].contact.is_some() {
            return Finding::Excluded;
        }
        match chosen {
            [one] => self.single(one, accept),
            [first, second] => self.curve(&[*first, *second], accept),
            [a, b, c] => self.line(&[*a, *b, *c], accept),
            [a, b, c, d] => self.point(&[*a, *b, *c, *d], accept),
            _ => Finding::Excluded,
        }
    }

    /// One generator: only the stall pair, or a single cone edge that carries the whole stall
    /// force.
    fn single(&self, generator: &Generator, accept: &mut Accept<'_>) -> Finding {
        let problem = &self.conditions.problem;
        let contact = generator.contact.map(|i| &problem.contacts[i]);
        // its impulse
        let alpha = if contact.is_none() || problem.stall == 0.0 {
            0.0
        } else {
            problem.stall / generator.g[3]
        };
        if alpha < 0.0 || !alpha.is_finite() {
            return Finding::Excluded;
        }
        // the velocity that follows
        let push = contact.map_or(0.0, |_| alpha);
        let load = add_scaled(&problem.free, push, &velocity(&generator.g));
        let (v, feet) = SupportFriction::new(&problem.feet).solve(&load);
        let yielded = contact.map_or(0.0, |c| -(dot(&velocity(&c.n), &v) + c.gap_offset) / c.n[3]);
        let v = [v[0], v[1], v[2], yielded];
        let chosen = [*generator];
        let inequalities = self.conditions.inequalities(&chosen);
        if !yielded.is_finite() || self.conditions.violates(&inequalities, &v, 0.0) {
            return Finding::Excluded;
        }
        Finding::of_candidate(accept(&Candidate {
            feet,
            ..self.conditions.candidate(&chosen, &[alpha], v)
        }))
    }

    /// Four generators: V is a point.
    fn point(&self, chosen: &[Generator; 4], accept: &mut Accept<'_>) -> Finding {
        let conditions = &self.conditions;
        let Some(dual) = dual_basis(&chosen.map(|c| c.g)) else {
            return Finding::Excluded;
        };
        let equations = conditions.equations(chosen);
        let (rows, values) = (equations.map(|e| e.row), equations.map(|e| e.value));
        let Some(v) = solve_dense(rows, values, DEPENDENT) else {
            return self.degenerate(chosen, accept);
        };
        if conditions.violates(&conditions.inequalities(chosen), &v, 0.0) {
            return Finding::Excluded;
        }
        let ranges = dual.map(|w| conditions.range_along(&w, &v, &v));
        if ranges.iter().any(|range| range.high < -conditions.slack) {
            return Finding::Excluded;
        }
        let alpha = ranges.map(|range| range.midpoint());
        Finding::of_candidate(accept(&conditions.candidate(chosen, &alpha, v)))
    }

    /// Dependent rows: excluded where they contradict each other, else unclear.
    fn degenerate<const N: usize>(
        &self,
        chosen: &[Generator; N],
        accept: &mut Accept<'_>,
    ) -> Finding {
        let equations = self.conditions.equations(chosen);
        let v = least_squares(&equations);
        let miss = equations.iter().fold(0.0f64, |largest, e| {
            largest.max((dot(&e.row, &v) - e.value).abs())
        });
        if miss > 10.0 * self.conditions.slack {
            return Finding::Excluded;
        }
        Finding::of_candidate(accept(&self.conditions.candidate(chosen, &[0.0; N], v)))
    }

    /// Three generators: V on a line V0 + τ d.
    fn line(&self, chosen: &[Generator; 3], accept: &mut Accept<'_>) -> Finding {
        let conditions = &self.conditions;
        // the line, and the direction m in which no generator pushes
        let equations = conditions.equations(chosen);
        let Some(m) = null_vector(&chosen.map(|c| c.g)) else {
            return Finding::Excluded;
        };
        let Some(d) = null_vector(&equations.map(|e| e.row)) else {
            return self.degenerate(chosen, accept);
        };
        let origin = least_squares(&equations);
        let inequalities = conditions.inequalities(chosen);
        let whole = self.line_interval(&origin, &d, &m, &inequalities);
        if whole.is_empty() {
            return Finding::Excluded;
        }
        let whole = Interval {
            low: whole.low.max(-FARTHEST),
            high: whole.high.min(FARTHEST),
        };
        // a piece of it needs impulses α ≥ 0 and nothing left along m
        let [a, b, c] = chosen.map(|c| c.g);
        let Some(dual) = dual_basis(&[a, b, c, m]) else {
            return Finding::Excluded;
        };
        let mut examine = |piece: Interval| {
            let at = |tau: f64| add_scaled(&origin, tau, &d);
            let (low, high) = (at(piece.low), at(piece.high));
            let [a, b, c, along_m] = dual.map(|w| conditions.range_along(&w, &low, &high));
            let balanced = along_m.low <= conditions.slack && along_m.high >= -conditions.slack;
            if !balanced || [a, b, c].iter().any(|r| r.high < -conditions.slack) {
                return Piece::Excluded;
            }
            let alpha = [a, b, c].map(|range| range.midpoint());
            Piece::Candidate(conditions.candidate(chosen, &alpha, at(piece.midpoint())))
        };
        bisect(whole, self.max_pieces, &mut examine, accept)
    }

    /// The part of the line where the inequalities hold and the friction of the feet can balance
    /// along m.
    fn line_interval(
        &self,
        origin: &Vector<4>,
        d: &Vector<4>,
        m: &Vector<4>,
        inequalities: &[Inequality],
    ) -> Interval {
        let conditions = &self.conditions;
        let mut interval = Interval {
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        };
        for Inequality { row, offset } in inequalities {
            interval.clip(dot(row, d), dot(row, origin) + offset + conditions.slack);
        }
        let bound = conditions.friction_bound(&velocity(m)) + conditions.slack;
        let at_origin = conditions.load_along(m, origin);
        let slope = dot(&velocity(m), &velocity(d));
        interval.clip(slope, at_origin + bound);
        interval.clip(-slope, -at_origin + bound);
        interval
    }

    /// Two generators: V on a curve, whose v is 1-Lipschitz in its load.
    fn curve(&self, chosen: &[Generator; 2], accept: &mut Accept<'_>) -> Finding {
        let conditions = &self.conditions;
        let Some(curve) = ModeCurve::new(conditions, chosen) else {
            return Finding::Excluded;
        };
        let whole = curve.interval(conditions);
        if whole.is_empty() {
            return Finding::Excluded;
        }
        let whole = Interval {
            high: whole.high.min(FARTHEST),
            ..whole
        };
        let inequalities = conditions.inequalities(chosen);
        let mut support = SupportFriction::new(&conditions.problem.feet);
        let mut examine = |piece: Interval| {
            let middle = piece.midpoint();
            // no v of the piece is farther than this from the middle's
            let reach = 0.5 * (piece.high - piece.low) * norm(&curve.load);
            let (v, feet) = support.solve(&add_scaled(&curve.load_0, middle, &curve.load));
            let miss = (dot(&curve.w, &v) + curve.offset).abs();
            if miss > reach * norm(&curve.w) + conditions.slack {
                return Piece::Excluded;
            }
            let v = [v[0], v[1], v[2], curve.pusher_yield(&v)];
            if conditions.violates(&inequalities, &v, reach * (1.0 + curve.yield_gain())) {
                return Piece::Excluded;
            }
            let alpha = curve.impulses(middle);
            Piece::Candidate(Candidate {
                feet,
                ..conditions.candidate(chosen, &alpha, v)
            })
        };
        bisect(whole, self.max_pieces, &mut examine, accept)
    }
}
