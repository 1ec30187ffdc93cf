//! The last solver: exhaustive search over contact modes. It finds a solution or proves that there
//! is none.
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

use crate::solver::mode_rows::{Guess, Rows, Vector, dot, norm, plus, solve_dense};
use crate::solver::subspace::{
    DEPENDENT, Equation, clip, dual_basis, first_three, least_squares, null_vector, unit_range,
};
use crate::solver::support_friction::Drag;

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

/// Violations below this [m/s, relative to the speed scale] do not exclude a mode.
const SLACK: f64 = 1e-9;

/// Sizes of subsets in the order in which they are gone through: points and lines cost a few
/// products, every piece of a curve a problem of its own.
const CHEAPEST_FIRST: [usize; 4] = [4, 1, 3, 2];

/// Pieces of a line or curve that may be looked at before it counts as unclear: in a first and a
/// second round.
const PIECES: [usize; 2] = [2_000, 50_000];

/// Widths of pieces below which candidates are polished [m/s, relative where above 1]: where an
/// object creeps, only the middle of a narrow piece is near the solution.
const WIDTHS: [f64; 3] = [1e-5, 1e-8, 1e-11];

/// Candidates of one line or curve that are polished at each of these; its pieces differ little, so
/// that more would not help.
const ATTEMPTS: u32 = 6;

/// An extreme direction of a friction cone (`sign` = ±1 or 0 where μ = 0), or the stall pair
/// (`contact` = None).
#[derive(Clone, Copy, Debug)]
struct Generator {
    contact: Option<usize>,
    sign: f64,
    g: Vector<4>,
}

/// What one subset of generators has to say.
enum Finding {
    Excluded,
    Solved,
    Unclear,
}

fn offered(accepted: bool) -> Finding {
    if accepted {
        Finding::Solved
    } else {
        Finding::Unclear
    }
}

/// Searches all modes, and those again with more patience where something was unclear; see
/// [`Search::run`].
pub fn search(rows: &Rows, accept: &mut dyn FnMut(&Guess) -> bool) -> Verdict {
    let mut verdict = Verdict::Unresolved;
    for pieces in PIECES {
        verdict = Search::new(rows, pieces).run(accept);
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

struct Search {
    rows: Rows,
    generators: Vec<Generator>,
    rigid: bool,
    slack: f64,
    pieces: usize,
}

impl Search {
    fn new(rows: &Rows, pieces: usize) -> Self {
        let rigid = !rows.stall.is_finite();
        let mut rows = rows.clone();
        if rigid {
            // the yield then has no effect and the fourth balance reads 0 = 0
            rows.stall = 0.0;
            for c in &mut rows.contacts {
                (c.n[3], c.t[3]) = (0.0, 0.0);
            }
        }
        let mut generators = vec![Generator {
            contact: None,
            sign: 0.0,
            g: [0.0, 0.0, 0.0, 1.0],
        }];
        let repeats = |i: usize| (0..i).any(|j| rows.contacts[j].repeats(&rows.contacts[i]));
        for (i, c) in rows
            .contacts
            .iter()
            .enumerate()
            .filter(|(i, _)| !repeats(*i))
        {
            let signs: &[f64] = if c.mu > 0.0 { &[1.0, -1.0] } else { &[0.0] };
            generators.extend(signs.iter().map(|&sign| Generator {
                contact: Some(i),
                sign,
                g: plus(&c.n, sign * c.mu, &c.t),
            }));
        }
        let slack = SLACK * rows.speed_scale.max(1.0);
        Self {
            rows,
            generators,
            rigid,
            slack,
            pieces,
        }
    }

    /// Goes through all subsets of generators; `accept` polishes and certifies a candidate.
    fn run(&self, accept: &mut dyn FnMut(&Guess) -> bool) -> Verdict {
        let mut clear = true;
        for size in CHEAPEST_FIRST {
            for subset in subsets(self.generators.len(), size) {
                let chosen: Vec<Generator> = subset.iter().map(|i| self.generators[*i]).collect();
                match self.examine(&chosen, accept) {
                    Finding::Solved => return Verdict::Solved,
                    Finding::Unclear => clear = false,
                    Finding::Excluded => {}
                }
            }
        }
        if clear {
            Verdict::Infeasible
        } else {
            Verdict::Unresolved
        }
    }

    fn examine(&self, chosen: &[Generator], accept: &mut dyn FnMut(&Guess) -> bool) -> Finding {
        if self.rigid && chosen[0].contact.is_some() {
            return Finding::Excluded;
        }
        match chosen {
            [one] => self.single(one, accept),
            [first, second] => self.curve([*first, *second], accept),
            [a, b, c] => self.line([*a, *b, *c], accept),
            [a, b, c, d] => self.point([*a, *b, *c, *d], accept),
            _ => Finding::Excluded,
        }
    }

    /// The conditions on V that the chosen generators demand, one each.
    fn equations<const N: usize>(&self, chosen: &[Generator; N]) -> [Equation; N] {
        std::array::from_fn(|k| match chosen[k].contact {
            None => Equation {
                row: [0.0, 0.0, 0.0, 1.0],
                value: 0.0,
            },
            Some(i) => {
                let c = &self.rows.contacts[i];
                let sticks = k > 0 && chosen[k - 1].contact == Some(i);
                if sticks {
                    Equation {
                        row: c.t,
                        value: -c.slip,
                    }
                } else {
                    Equation {
                        row: c.n,
                        value: -c.gap,
                    }
                }
            }
        })
    }

    /// Inequalities a·V + b ≥ 0 that hold at a solution of this mode: open gaps, slip directions, y
    /// ≥ 0.
    fn inequalities(&self, chosen: &[Generator]) -> Vec<(Vector<4>, f64)> {
        let mut all: Vec<(Vector<4>, f64)> =
            self.rows.contacts.iter().map(|c| (c.n, c.gap)).collect();
        all.push(([0.0, 0.0, 0.0, 1.0], 0.0));
        for generator in chosen {
            let Some(c) = generator.contact.map(|i| &self.rows.contacts[i]) else {
                continue;
            };
            // p_t = sign μ p_n opposes the slip
            all.push((c.t.map(|x| -generator.sign * x), -generator.sign * c.slip));
        }
        all
    }

    /// Whether V violates one of `inequalities` by more than `margin` times its row and the slack.
    fn violates(&self, inequalities: &[(Vector<4>, f64)], v: &Vector<4>, margin: f64) -> bool {
        inequalities
            .iter()
            .any(|(a, b)| dot(a, v) + b < -self.slack - margin * norm(a))
    }

    fn candidate(&self, chosen: &[Generator], alpha: &[f64], v: Vector<4>) -> Guess {
        let mut guess = Guess {
            v,
            contacts: vec![[0.0; 2]; self.rows.contacts.len()],
            feet: self.sliding_feet(&v),
        };
        for (generator, &a) in chosen.iter().zip(alpha) {
            if let Some(i) = generator.contact {
                guess.contacts[i][0] += a.max(0.0);
                guess.contacts[i][1] += a.max(0.0) * generator.sign * self.rows.contacts[i].mu;
            }
        }
        guess
    }

    fn sliding_feet(&self, v: &Vector<4>) -> [[f64; 2]; 3] {
        self.rows.feet.map(|foot| {
            let s = foot.slip(v);
            let length = s[0].hypot(s[1]);
            if length > 1e-12 {
                s.map(|x| -foot.bound * x / length)
            } else {
                [0.0; 2]
            }
        })
    }

    /// One generator: only the stall pair, or a single cone edge that carries the whole stall
    /// force.
    fn single(&self, generator: &Generator, accept: &mut dyn FnMut(&Guess) -> bool) -> Finding {
        let alpha = if generator.contact.is_none() || self.rows.stall == 0.0 {
            0.0
        } else {
            self.rows.stall / generator.g[3]
        };
        if alpha < 0.0 || !alpha.is_finite() {
            return Finding::Excluded;
        }
        let push = generator.contact.map_or(0.0, |_| alpha);
        let (v, feet) = Drag::on(&self.rows.feet).under(&plus(
            &self.rows.free,
            push,
            &first_three(&generator.g),
        ));
        let yielded = match generator.contact.map(|i| &self.rows.contacts[i]) {
            None => 0.0,
            Some(c) => -(dot(&first_three(&c.n), &v) + c.gap) / c.n[3],
        };
        let v = [v[0], v[1], v[2], yielded];
        if !yielded.is_finite() || self.violates(&self.inequalities(&[*generator]), &v, 0.0) {
            return Finding::Excluded;
        }
        let guess = Guess {
            feet,
            ..self.candidate(&[*generator], &[alpha], v)
        };
        offered(accept(&guess))
    }

    /// Four generators: V is a point.
    fn point(&self, chosen: [Generator; 4], accept: &mut dyn FnMut(&Guess) -> bool) -> Finding {
        let Some(dual) = dual_basis(&chosen.map(|c| c.g)) else {
            return Finding::Excluded;
        };
        let equations = self.equations(&chosen);
        let Some(v) = solve_dense(
            equations.map(|e| e.row),
            equations.map(|e| e.value),
            DEPENDENT,
        ) else {
            return self.degenerate(&chosen, accept);
        };
        let inequalities = self.inequalities(&chosen);
        if self.violates(&inequalities, &v, 0.0) {
            return Finding::Excluded;
        }
        let ranges = dual.map(|w| self.functional_range(&w, &v, &v));
        if ranges.iter().any(|r| r.1 < -self.slack) {
            return Finding::Excluded;
        }
        let alpha = ranges.map(|r| 0.5 * (r.0 + r.1));
        offered(accept(&self.candidate(&chosen, &alpha, v)))
    }

    /// Dependent rows: excluded where they contradict each other, else unclear.
    fn degenerate<const N: usize>(
        &self,
        chosen: &[Generator; N],
        accept: &mut dyn FnMut(&Guess) -> bool,
    ) -> Finding {
        let equations = self.equations(chosen);
        let v = least_squares(&equations);
        let miss = equations.iter().fold(0.0f64, |worst, e| {
            worst.max((dot(&e.row, &v) - e.value).abs())
        });
        if miss > 10.0 * self.slack {
            return Finding::Excluded;
        }
        offered(accept(&self.candidate(chosen, &[0.0; N], v)))
    }

    /// Three generators: V on a line V0 + τ d.
    fn line(&self, chosen: [Generator; 3], accept: &mut dyn FnMut(&Guess) -> bool) -> Finding {
        let equations = self.equations(&chosen);
        let direction = null_vector(&equations.map(|e| e.row));
        let normal = null_vector(&chosen.map(|c| c.g));
        let [Some(d), Some(m)] = [direction, normal] else {
            return if normal.is_none() {
                Finding::Excluded
            } else {
                self.degenerate(&chosen, accept)
            };
        };
        let origin = least_squares(&equations);
        let inequalities = self.inequalities(&chosen);
        let Some((low, high)) = self.line_interval(&origin, &d, &m, &inequalities) else {
            return Finding::Excluded;
        };
        let Some(dual) = dual_basis(&[chosen[0].g, chosen[1].g, chosen[2].g, m]) else {
            return Finding::Excluded;
        };

        self.bisect(
            (low, high),
            &mut |low, high| {
                let (a, b) = (plus(&origin, low, &d), plus(&origin, high, &d));
                let ranges = dual.map(|w| self.functional_range(&w, &a, &b));
                let balanced = ranges[3].0 <= self.slack && ranges[3].1 >= -self.slack;
                if !balanced || ranges[..3].iter().any(|r| r.1 < -self.slack) {
                    return Piece::Excluded;
                }
                let alpha = [0, 1, 2].map(|k| 0.5 * (ranges[k].0 + ranges[k].1));
                Piece::Candidate(self.candidate(
                    &chosen,
                    &alpha,
                    plus(&origin, 0.5 * (low + high), &d),
                ))
            },
            accept,
        )
    }

    /// The part of the line where the inequalities hold and the friction of the feet can balance
    /// along m.
    fn line_interval(
        &self,
        origin: &Vector<4>,
        d: &Vector<4>,
        m: &Vector<4>,
        inequalities: &[(Vector<4>, f64)],
    ) -> Option<(f64, f64)> {
        let mut interval = (f64::NEG_INFINITY, f64::INFINITY);
        for (a, b) in inequalities {
            clip(&mut interval, dot(a, d), dot(a, origin) + b + self.slack);
        }
        let m3 = first_three(m);
        let drag_bound = self.drag_bound(&m3) + self.slack;
        let base =
            dot(&m3, &plus(&first_three(origin), -1.0, &self.rows.free)) + m[3] * self.rows.stall;
        let slope = dot(&m3, &first_three(d));
        clip(&mut interval, slope, base + drag_bound);
        clip(&mut interval, -slope, -base + drag_bound);
        (interval.0 <= interval.1).then_some((interval.0.max(-1e6), interval.1.min(1e6)))
    }

    /// Largest |w·Σ J_kᵀ p_k|.
    fn drag_bound(&self, w: &Vector<3>) -> f64 {
        self.rows
            .feet
            .iter()
            .map(|foot| foot.bound * foot.slip(w)[0].hypot(foot.slip(w)[1]))
            .sum()
    }

    /// Range of w·T(V) for V on the segment from a to b.
    fn functional_range(&self, w: &Vector<4>, a: &Vector<4>, b: &Vector<4>) -> (f64, f64) {
        let w3 = first_three(w);
        let base = |v: &Vector<4>| {
            dot(&w3, &plus(&first_three(v), -1.0, &self.rows.free)) + w[3] * self.rows.stall
        };
        let (at_a, at_b) = (base(a), base(b));
        let mut range = (at_a.min(at_b), at_a.max(at_b));
        for foot in &self.rows.feet {
            let part = unit_range(foot.slip(&w3), foot.slip(a), foot.slip(b));
            range.0 += foot.bound * part.0;
            range.1 += foot.bound * part.1;
        }
        range
    }

    /// Two generators: α_a a + α_b b with the fourth balance fixing one of them; v(λ) = T⁻¹ is
    /// 1-Lipschitz in its load.
    fn curve(&self, chosen: [Generator; 2], accept: &mut dyn FnMut(&Guess) -> bool) -> Finding {
        let swap = chosen[0].g[3].abs() > chosen[1].g[3].abs();
        let (free, tied) = if swap {
            (chosen[1], chosen[0])
        } else {
            (chosen[0], chosen[1])
        };
        if tied.g[3] == 0.0 {
            return Finding::Excluded;
        }
        let ratio = -free.g[3] / tied.g[3];
        let constant = self.rows.stall / tied.g[3];
        let load0 = plus(&self.rows.free, constant, &first_three(&tied.g));
        let load = plus(&first_three(&free.g), ratio, &first_three(&tied.g));

        // one row gives y, the other is the equation to solve
        let [e0, e1] = self.equations(&chosen);
        let (gives_y, solve) = if e0.row[3].abs() > e1.row[3].abs() {
            (e0, e1)
        } else {
            (e1, e0)
        };
        if gives_y.row[3] == 0.0 {
            return Finding::Excluded;
        }
        let k = solve.row[3] / gives_y.row[3];
        let w = plus(&first_three(&solve.row), -k, &first_three(&gives_y.row));
        let offset = k * gives_y.value - solve.value;

        let mut interval = (0.0, f64::INFINITY);
        clip(&mut interval, ratio, constant + self.slack);
        let drag_bound = self.drag_bound(&w) + self.slack;
        clip(
            &mut interval,
            dot(&w, &load),
            dot(&w, &load0) + offset + drag_bound,
        );
        clip(
            &mut interval,
            -dot(&w, &load),
            -dot(&w, &load0) - offset + drag_bound,
        );
        if interval.0 > interval.1 {
            return Finding::Excluded;
        }
        let inequalities = self.inequalities(&chosen);
        let mut drag = Drag::on(&self.rows.feet);
        let y_gain = norm(&first_three(&gives_y.row)) / gives_y.row[3].abs();
        self.bisect(
            (interval.0, interval.1.min(1e6)),
            &mut |low, high| {
                let middle = 0.5 * (low + high);
                let reach = 0.5 * (high - low) * norm(&load);
                let (v, feet) = drag.under(&plus(&load0, middle, &load));
                if (dot(&w, &v) + offset).abs() > reach * norm(&w) + self.slack {
                    return Piece::Excluded;
                }
                let y = (gives_y.value - dot(&first_three(&gives_y.row), &v)) / gives_y.row[3];
                let v = [v[0], v[1], v[2], y];
                if self.violates(&inequalities, &v, reach * (1.0 + y_gain)) {
                    return Piece::Excluded;
                }
                let alpha = if swap {
                    [ratio * middle + constant, middle]
                } else {
                    [middle, ratio * middle + constant]
                };
                Piece::Candidate(Guess {
                    feet,
                    ..self.candidate(&chosen, &alpha, v)
                })
            },
            accept,
        )
    }

    /// Halves the whole interval until every piece is excluded or a candidate is accepted.
    fn bisect(
        &self,
        whole: (f64, f64),
        examine: &mut dyn FnMut(f64, f64) -> Piece,
        accept: &mut dyn FnMut(&Guess) -> bool,
    ) -> Finding {
        let mut stack = vec![whole];
        let mut unclear = false;
        let mut attempts = [ATTEMPTS; WIDTHS.len()];
        let mut budget = self.pieces;
        while let Some((low, high)) = stack.pop() {
            if budget == 0 {
                return Finding::Unclear;
            }
            budget -= 1;
            let Piece::Candidate(guess) = examine(low, high) else {
                continue;
            };
            let width = (high - low) / (1.0 + low.abs().max(high.abs()));
            let narrowest = WIDTHS.iter().rposition(|limit| width < *limit);
            if let Some(left) = narrowest.map(|k| &mut attempts[k])
                && *left > 0
            {
                *left -= 1;
                if accept(&guess) {
                    return Finding::Solved;
                }
            }
            if width < 1e-12 {
                unclear = true;
                continue;
            }
            let middle = 0.5 * (low + high);
            stack.push((middle, high));
            stack.push((low, middle));
        }
        if unclear {
            Finding::Unclear
        } else {
            Finding::Excluded
        }
    }
}

/// What is known of one piece of a line or curve.
enum Piece {
    Excluded,
    Candidate(Guess),
}
