//! Exhaustive search over contact modes: [`search`] finds a solution or proves that there is none.
//!
//! A solution is a V = (v, y) and impulses α ≥ 0 with Σ α g = T(V), where T(V) = (v − v_free − Σ
//! J_kᵀ p_k(v), F_stall h / m). The *generators* g are the two edges n ± μ t of every closed
//! contact's friction cone and the unit vector of the stall pair. By Carathéodory's theorem at most
//! four linearly independent generators suffice.
//!
//! Each generator demands that its own row of V vanish: the gap velocity, the slip velocity where
//! both edges of a contact are used, y for the stall pair. So a subset of four leaves a point, of
//! three a line, of two a curve v(λ) = T⁻¹(…), of one again a point. Parallel walls, and points of
//! one face, demand a row of V twice: four generators then leave a line, three a plane.
//!
//! Most subsets are discarded by V alone: the half-spaces of open gaps, opposed slips, y ≥ 0 and
//! the limit on speed leave nothing of the plane, line or point. The others are searched by
//! halving, with bounds that are rigorous on every piece: pieces without a solution are discarded,
//! the rest is refined. If nothing remains, there is no solution.

use crate::solver::elimination::solve_dense;
use crate::solver::exhaustive::certifier::Certifier;
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::mode_conditions::{LARGEST, ModeConditions};
use crate::solver::exhaustive::mode_curve::ModeCurve;
use crate::solver::exhaustive::mode_line::{Line, ModeLine};
use crate::solver::exhaustive::open_planes::OpenPlanes;
use crate::solver::exhaustive::piece_search::{Finding, Thoroughness, search_path};
use crate::solver::exhaustive::plane_region::complement;
use crate::solver::exhaustive::redundant_line::RedundantLine;
use crate::solver::exhaustive::redundant_plane::RedundantPlane;
use crate::solver::exhaustive::scalar_ncp::{Candidate, ScalarNcp};
use crate::solver::exhaustive::subspace::{DEPENDENT, dual_basis, least_squares, null_vector};
use crate::solver::exhaustive::support_friction::SupportFriction;
use crate::solver::vector::{add_scaled, dot, velocity};

/// Outcome of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A candidate was certified.
    Solved,
    /// Every mode was excluded: the problem has no solution.
    Infeasible,
    /// Some piece of some mode could be neither excluded nor certified.
    Unresolved,
}

/// Sizes of subsets in the order in which they are searched: points and lines cost a few products,
/// every piece of a curve a problem of its own.
const CHEAPEST_FIRST: [usize; 4] = [4, 1, 3, 2];

/// Thoroughness of the search of lines and curves: in a first round and, where something was
/// unclear, in later ones. Most solutions show at a first glance, though seldom in the first
/// subset.
const ROUNDS: [Thoroughness; 3] = [
    Thoroughness {
        pieces: 128,
        gives_up: 1e-8,
        attempts: 1,
        patience: 16,
        separates: false,
        stands: false,
    },
    Thoroughness {
        pieces: 2_000,
        gives_up: 0.0,
        attempts: 6,
        patience: u32::MAX,
        separates: true,
        stands: false,
    },
    Thoroughness {
        pieces: 50_000,
        gives_up: 0.0,
        attempts: 6,
        patience: u32::MAX,
        separates: true,
        stands: true,
    },
];

/// Searches all modes, and again more thoroughly where something was unclear and work is left.
pub fn search(problem: &ScalarNcp, certifier: &mut Certifier<'_>) -> Verdict {
    let search = ModeSearch::new(problem);
    if search.rests(certifier) {
        return Verdict::Solved;
    }
    let mut unclear = search.subsets(certifier);
    for thoroughness in ROUNDS {
        certifier.begin_round(thoroughness.patience);
        match search.round(&unclear, thoroughness, certifier) {
            Round::Solved => return Verdict::Solved,
            Round::Unclear(left) if left.is_empty() => return Verdict::Infeasible,
            Round::Unclear(left) => unclear = left,
        }
    }
    Verdict::Unresolved
}

/// Outcome of a round.
enum Round {
    /// A candidate was certified.
    Solved,
    /// These subsets were not excluded.
    Unclear(Vec<Subset>),
}

/// At most four generators, by number, in increasing order.
#[derive(Clone, Copy, Debug)]
struct Subset {
    size: usize,
    members: [usize; 4],
}

impl Subset {
    fn of(members: &[usize]) -> Self {
        let mut all = [0; 4];
        all[..members.len()].copy_from_slice(members);
        Self {
            size: members.len(),
            members: all,
        }
    }

    fn with(mut self, next: usize) -> Self {
        self.members[self.size] = next;
        self.size += 1;
        self
    }
}

/// The search of one problem.
struct ModeSearch {
    conditions: ModeConditions,
    generators: Vec<Generator>,
    rigid: bool,
    planes: OpenPlanes,
}

impl ModeSearch {
    fn new(problem: &ScalarNcp) -> Self {
        // no impulses that are sought make a stronger drive yield
        let rigid = problem.stall > LARGEST;
        let mut problem = problem.clone();
        if rigid {
            // the yield then has no effect and the fourth balance reads 0 = 0
            problem.stall = 0.0;
            for c in &mut problem.contacts {
                (c.n[3], c.t[3]) = (0.0, 0.0);
            }
        }
        let generators = Generator::all(&problem);
        let conditions = ModeConditions::new(problem);
        // with a rigid pusher, every mode has its stall pair
        let firsts = if rigid { 1 } else { generators.len() };
        Self {
            planes: OpenPlanes::new(&conditions, &generators, firsts),
            generators,
            conditions,
            rigid,
        }
    }

    /// Returns true if the object can stand still, held by all contacts that are closed then, while
    /// the pusher yields as far as it must. Nearly all subsets hold a wedged object, and each would
    /// be searched.
    fn rests(&self, certifier: &mut Certifier<'_>) -> bool {
        let conditions = &self.conditions;
        let contacts = conditions.problem.contacts.iter();
        let yields = contacts
            .filter(|c| c.n[3] > 0.0)
            .map(|c| -c.gap_offset / c.n[3]);
        let still = [0.0, 0.0, 0.0, yields.fold(0.0, f64::max)];
        if conditions.violates(&[], &still, 0.0) {
            return false;
        }
        let generators = self.generators.iter();
        let holding: Vec<_> = generators
            .filter(|generator| conditions.holds(generator, &still))
            .copied()
            .collect();
        conditions.stands(&holding, &still, certifier)
    }

    /// Examines subsets of generators until one has a solution.
    fn round(
        &self,
        subsets: &[Subset],
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> Round {
        let mut unclear = Vec::new();
        for size in CHEAPEST_FIRST {
            for subset in subsets.iter().filter(|subset| subset.size == size) {
                // without work left, none is excluded
                if certifier.left() == 0 {
                    unclear.push(*subset);
                    continue;
                }
                certifier.spend(1);
                let chosen = subset.members.map(|i| self.generators[i]);
                match self.examine(&chosen[..size], thoroughness, certifier) {
                    Finding::Solved => return Round::Solved,
                    Finding::Unclear => unclear.push(*subset),
                    Finding::Excluded => {}
                }
            }
        }
        Round::Unclear(unclear)
    }

    /// The subsets for which V can meet the conditions of every two and three of their generators:
    /// more generators demand more of V.
    fn subsets(&self, certifier: &mut Certifier<'_>) -> Vec<Subset> {
        let n = self.generators.len();
        // a rigid pusher does not yield: its stall pair is always among them
        let firsts = if self.rigid { 1 } else { n };
        let mut all: Vec<_> = (0..firsts).map(|i| Subset::of(&[i])).collect();
        let mut possible = vec![false; n * n];
        for i in 0..firsts {
            for j in i + 1..n {
                possible[i * n + j] = self.plane_is_possible(&[i, j]);
                if possible[i * n + j] {
                    all.push(Subset::of(&[i, j]));
                }
            }
            certifier.spend((n - i) as u32);
        }
        // three: one more generator, possible with each of the others
        let pairs = firsts..all.len();
        for k in pairs.clone() {
            let [i, j, ..] = all[k].members;
            for next in j + 1..n {
                let with_each = possible[i * n + next] && (self.rigid || possible[j * n + next]);
                if with_each && self.line_is_possible(&[i, j, next]) {
                    all.push(all[k].with(next));
                    // with a rigid pusher, what is possible with its stall pair
                    possible[j * n + next] = true;
                }
            }
            certifier.spend((n - j) as u32);
        }
        // four
        for k in pairs.end..all.len() {
            let [i, j, l, _] = all[k].members;
            for next in l + 1..n {
                if [i, j, l].iter().all(|i| possible[i * n + next]) {
                    all.push(all[k].with(next));
                }
            }
        }
        certifier.spend((all.len() / 4) as u32);
        all
    }

    /// Returns true if some V meets the conditions of two generators.
    fn plane_is_possible(&self, members: &[usize; 2]) -> bool {
        self.planes
            .of(&self.conditions, &members.map(|i| self.generators[i]))
            .is_none_or(|region| !region.is_empty())
    }

    /// Returns true if some V meets the conditions of three generators.
    fn line_is_possible(&self, members: &[usize; 3]) -> bool {
        let chosen = members.map(|i| self.generators[i]);
        Line::new(&self.conditions.equations(&chosen))
            .is_none_or(|line| !line.interval(&self.conditions, &chosen).is_empty())
    }

    fn examine(
        &self,
        chosen: &[Generator],
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> Finding {
        match chosen {
            [one] => self.single(one, certifier),
            [first, second] => self.curve(&[*first, *second], thoroughness, certifier),
            [a, b, c] => self.line(&[*a, *b, *c], thoroughness, certifier),
            [a, b, c, d] => self.point(&[*a, *b, *c, *d], thoroughness, certifier),
            _ => Finding::Excluded,
        }
    }

    /// One generator: only the stall pair, or a single cone edge that carries the whole stall
    /// force.
    fn single(&self, generator: &Generator, certifier: &mut Certifier<'_>) -> Finding {
        let problem = &self.conditions.problem;
        let contact = generator.contact.map(|i| &problem.contacts[i]);
        // its impulse
        let alpha = if contact.is_none() || problem.stall == 0.0 {
            0.0
        } else {
            problem.stall / generator.g[3]
        };
        if !(0.0..=LARGEST).contains(&alpha) {
            return Finding::Excluded;
        }
        // the velocity that follows
        let push = contact.map_or(0.0, |_| alpha);
        let load = add_scaled(&problem.free, push, &velocity(&generator.g));
        let moved = SupportFriction::new(&problem.feet).solve(&load);
        certifier.spend(moved.systems);
        let v = moved.v;
        let yielded = contact.map_or(0.0, |c| -(dot(&velocity(&c.n), &v) + c.gap_offset) / c.n[3]);
        let v = [v[0], v[1], v[2], yielded];
        let chosen = [*generator];
        if !yielded.is_finite() || self.conditions.violates(&chosen, &v, 0.0) {
            return Finding::Excluded;
        }
        Finding::of_candidate(certifier.certifies(&Candidate {
            feet: moved.feet,
            ..self.conditions.candidate(&chosen, &[alpha], v)
        }))
    }

    /// Four generators: V is a point.
    fn point(
        &self,
        chosen: &[Generator; 4],
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> Finding {
        let conditions = &self.conditions;
        let equations = conditions.equations(chosen);
        let (rows, values) = (equations.map(|e| e.row), equations.map(|e| e.value));
        let v = solve_dense(rows, values, DEPENDENT);
        if v.is_some_and(|v| conditions.violates(chosen, &v, 0.0)) {
            return Finding::Excluded;
        }
        let Some(dual) = dual_basis(&chosen.map(|c| c.g)) else {
            return Finding::Excluded;
        };
        let Some(v) = v else {
            let Some(line) = Line::of_dependent(&equations) else {
                return self.degenerate(chosen, certifier);
            };
            let mut path = RedundantLine::new(conditions, chosen, line, dual);
            return search_path(path.interval(), &mut path, thoroughness, certifier);
        };
        let ranges = dual.map(|w| conditions.range_along(&w, &v, &v));
        if !conditions.allows(&ranges) {
            return Finding::Excluded;
        }
        if thoroughness.separates && conditions.separates(chosen, &[v], certifier) {
            return Finding::Excluded;
        }
        let alpha = ranges.map(|range| range.midpoint());
        let solved = conditions.solves(chosen, &alpha, &v, thoroughness.stands, certifier);
        Finding::of_candidate(solved)
    }

    /// Searches rows that leave neither a line nor a plane: excluded where they contradict each
    /// other, else unclear.
    ///
    /// The residual of the best V is a combination of the rows that vanishes. So it bounds from
    /// below by how much every V misses one of the equations.
    fn degenerate<const N: usize>(
        &self,
        chosen: &[Generator; N],
        certifier: &mut Certifier<'_>,
    ) -> Finding {
        let equations = self.conditions.equations(chosen);
        let v = least_squares(&equations);
        let miss = equations.map(|e| dot(&e.row, &v) - e.value);
        let sum: f64 = miss.iter().map(|x| x.abs()).sum();
        if dot(&miss, &miss) > self.conditions.slack * sum {
            return Finding::Excluded;
        }
        Finding::of_candidate(certifier.certifies(&self.conditions.candidate(chosen, &[0.0; N], v)))
    }

    /// Three generators: V on a line.
    fn line(
        &self,
        chosen: &[Generator; 3],
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> Finding {
        let (conditions, [a, b, c]) = (&self.conditions, chosen.map(|generator| generator.g));
        let Some(m) = null_vector(&[a, b, c]) else {
            return Finding::Excluded;
        };
        let dual = || dual_basis(&[a, b, c, m]);
        let Some(line) = Line::new(&conditions.equations(chosen)) else {
            let Some(dual) = dual() else {
                return Finding::Excluded;
            };
            return match RedundantPlane::new(conditions, chosen, dual) {
                Some(plane) => plane.search(thoroughness, certifier),
                None => self.degenerate(chosen, certifier),
            };
        };
        let interval = line.balanced_interval(conditions, chosen, &m);
        if interval.is_empty() {
            return Finding::Excluded;
        }
        let Some(dual) = dual() else {
            return Finding::Excluded;
        };
        let mut path = ModeLine::new(conditions, chosen, line, dual);
        search_path(interval, &mut path, thoroughness, certifier)
    }

    /// Two generators: V on a curve.
    fn curve(
        &self,
        chosen: &[Generator; 2],
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> Finding {
        if !self.plane_balances(chosen, certifier) {
            return Finding::Excluded;
        }
        match ModeCurve::new(&self.conditions, chosen) {
            Some(mut path) => search_path(path.interval(), &mut path, thoroughness, certifier),
            None => Finding::Excluded,
        }
    }

    /// Returns true if at some V of a plane the friction of the feet can balance the rest of the
    /// load that two generators leave with their impulses α ≥ 0.
    fn plane_balances(&self, chosen: &[Generator; 2], certifier: &mut Certifier<'_>) -> bool {
        let conditions = &self.conditions;
        let Some(mut region) = self.planes.of(conditions, chosen) else {
            return true;
        };
        let [a, b] = chosen.map(|generator| generator.g);
        let Some(dual) = complement(&a, &b).and_then(|[c, d]| dual_basis(&[a, b, c, d])) else {
            return true;
        };
        let [alpha, beta, c, d] = dual.map(|w| conditions.most_along(&w));
        let [less_c, less_d] = [dual[2], dual[3]].map(|w| conditions.most_along(&w.map(|x| -x)));
        for inequality in [alpha, beta, c, d, less_c, less_d] {
            region.clip(&inequality, conditions.slack);
        }
        let hull: Vec<_> = region.corners().collect();
        !hull.is_empty() && !conditions.separates(chosen, &hull, certifier)
    }
}
