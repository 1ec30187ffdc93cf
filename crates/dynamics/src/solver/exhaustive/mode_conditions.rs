//! Conditions that a choice of generators puts on V = (v, y): [`ModeConditions`].

use crate::solver::exhaustive::balance::{Balance, balance};
use crate::solver::exhaustive::certifier::Certifier;
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::load::Load;
use crate::solver::exhaustive::plane_region::PlaneRegion;
use crate::solver::exhaustive::scalar_ncp::{Candidate, ScalarNcp};
use crate::solver::exhaustive::subspace::Equation;
use crate::solver::vector::{Vector, add_scaled, dot, norm, velocity};

/// Violations below this (m/s, relative to the speed scale) do not exclude a mode.
const SLACK: f64 = 1e-9;

/// Slip below which a foot stands (m/s): far below the tolerance of a solution.
const STANDS: f64 = 1e-10;

/// Solutions with larger impulses, of the drive or of all contacts together, are not sought (m/s):
/// their rounding exceeds the certificate's tolerance.
pub const LARGEST: f64 = 1e6;

/// Speeds above this leave a balance too few digits (m/s).
const FASTEST: f64 = 1e3;

/// A linear condition row·V + offset ≥ 0.
#[derive(Clone, Copy, Debug)]
pub struct Inequality {
    /// Coefficients.
    pub row: Vector<4>,
    /// Constant.
    pub offset: f64,
}

/// A problem, and how far a solution may miss its conditions.
pub struct ModeConditions {
    /// The problem.
    pub problem: ScalarNcp,
    /// Violations below this do not exclude a mode (m/s).
    pub slack: f64,
    /// Conditions at every solution: gaps are open, y ≥ 0, no speed exceeds the limit.
    open: Vec<Inequality>,
}

impl ModeConditions {
    /// Of one problem.
    pub fn new(problem: ScalarNcp) -> Self {
        let gaps = problem.contacts.iter().map(|c| Inequality {
            row: c.n,
            offset: c.gap_offset,
        });
        let pusher_yield = Inequality {
            row: [0.0, 0.0, 0.0, 1.0],
            offset: 0.0,
        };
        let slow = (0..4).flat_map(|k| {
            [1.0, -1.0].map(|sign| {
                let mut row = [0.0; 4];
                row[k] = sign;
                Inequality {
                    row,
                    offset: problem.speed_limit,
                }
            })
        });
        Self {
            slack: SLACK * problem.speed_scale.max(1.0),
            open: gaps.chain([pusher_yield]).chain(slow).collect(),
            problem,
        }
    }

    /// One equation per generator: its gap velocity vanishes; of a contact's second edge the slip
    /// velocity; of the stall pair y.
    pub fn equations<const N: usize>(&self, chosen: &[Generator; N]) -> [Equation; N] {
        std::array::from_fn(|k| {
            let Some(i) = chosen[k].contact else {
                return Equation {
                    row: [0.0, 0.0, 0.0, 1.0],
                    value: 0.0,
                };
            };
            let c = &self.problem.contacts[i];
            let sticks = k > 0 && chosen[k - 1].contact == Some(i);
            let (row, offset) = if sticks {
                (c.t, c.slip_offset)
            } else {
                (c.n, c.gap_offset)
            };
            Equation {
                row,
                value: -offset,
            }
        })
    }

    /// Returns true if impulses of these ranges may be those of a solution.
    pub fn allows(&self, impulses: &[Interval]) -> bool {
        let possible = |it: &Interval| it.high >= -self.slack && it.low <= LARGEST;
        impulses.iter().all(possible)
    }

    /// Conditions at a solution in this mode: those of every solution, and slips oppose the
    /// friction.
    pub fn inequalities<'a>(
        &'a self,
        chosen: &'a [Generator],
    ) -> impl Iterator<Item = Inequality> + 'a {
        self.open.iter().copied().chain(self.slips(chosen))
    }

    /// Of these, the slips.
    pub fn slips<'a>(&'a self, chosen: &'a [Generator]) -> impl Iterator<Item = Inequality> + 'a {
        chosen.iter().filter_map(|generator| {
            // p_t = sign μ p_n opposes the slip
            let c = &self.problem.contacts[generator.contact?];
            Some(Inequality {
                row: c.t.map(|x| -generator.sign * x),
                offset: -generator.sign * c.slip_offset,
            })
        })
    }

    /// Part of the plane of two generators that the open gaps, y ≥ 0 and the limit on speed leave;
    /// `None` where their equations leave none.
    pub fn open_plane(&self, chosen: &[Generator; 2]) -> Option<PlaneRegion> {
        let mut region = PlaneRegion::new(&self.equations(chosen))?;
        for inequality in &self.open {
            region.clip(inequality, self.slack);
        }
        Some(region)
    }

    /// Returns true if V violates a condition of this mode by more than the slack, and more than it
    /// can gain over a distance of `margin`.
    pub fn violates(&self, chosen: &[Generator], v: &Vector<4>, margin: f64) -> bool {
        self.inequalities(chosen).any(|Inequality { row, offset }| {
            dot(&row, v) + offset < -self.slack - margin * norm(&row)
        })
    }

    /// Returns true if a generator may push at V: its contact is closed, and its friction opposes
    /// the slip.
    pub fn holds(&self, generator: &Generator, v: &Vector<4>) -> bool {
        let [equation] = self.equations(&[*generator]);
        (dot(&equation.row, v) - equation.value).abs() <= self.slack
            && !self.violates(&[*generator], v, 0.0)
    }

    /// Both sides of the generators' equations: V meets one to the slack.
    pub fn both_sides<const N: usize>(&self, chosen: &[Generator; N]) -> Vec<Inequality> {
        let sides = |Equation { row, value }: Equation| {
            [1.0, -1.0].map(|sign| Inequality {
                row: row.map(|x| sign * x),
                offset: -sign * value,
            })
        };
        self.equations(chosen).into_iter().flat_map(sides).collect()
    }

    /// The point V with the chosen generators' impulses `alpha` and feet that slide.
    pub fn candidate(&self, chosen: &[Generator], alpha: &[f64], v: Vector<4>) -> Candidate {
        let mut candidate = Candidate {
            v,
            contacts: vec![[0.0; 2]; self.problem.contacts.len()],
            feet: self.problem.sliding_feet(&v),
        };
        for (generator, &a) in chosen.iter().zip(alpha) {
            if let Some(i) = generator.contact {
                let [p_n, p_t] = &mut candidate.contacts[i];
                *p_n += a.max(0.0);
                *p_t += a.max(0.0) * generator.sign * self.problem.contacts[i].mu;
            }
        }
        candidate
    }

    /// Candidate at V with impulses that balance the load where feet stand; `None` where none were
    /// found, or no foot stands.
    pub fn standing_candidate(
        &self,
        chosen: &[Generator],
        v: &Vector<4>,
        certifier: &mut Certifier<'_>,
    ) -> Option<Candidate> {
        let stands = self.problem.feet.map(|foot| norm(&foot.slip(v)) < STANDS);
        if stands == [false; 3] {
            return None;
        }
        let load = Load::at(&self.problem, v, stands);
        let Balance::Met { alpha, directions } = balance_of(chosen, &load, certifier) else {
            return None;
        };
        let mut candidate = self.candidate(chosen, &alpha, *v);
        for k in (0..3).filter(|k| stands[*k]) {
            candidate.feet[k] = directions[k].map(|u| -self.problem.feet[k].bound * u);
        }
        Some(candidate)
    }

    /// Returns true if V with the impulses `alpha` refines to a certified solution. With `stands`,
    /// also tries impulses that balance the load.
    pub fn solves(
        &self,
        chosen: &[Generator],
        alpha: &[f64],
        v: &Vector<4>,
        stands: bool,
        certifier: &mut Certifier<'_>,
    ) -> bool {
        certifier.certifies(&self.candidate(chosen, alpha, *v))
            || stands && self.stands(chosen, v, certifier)
    }

    /// Returns true if V with impulses that balance the load where feet stand refines to a
    /// certified solution.
    pub fn stands(
        &self,
        chosen: &[Generator],
        v: &Vector<4>,
        certifier: &mut Certifier<'_>,
    ) -> bool {
        self.standing_candidate(chosen, v, certifier)
            .is_some_and(|candidate| certifier.certifies(&candidate))
    }

    /// Returns true if no impulses of the generators balance the load for any V of the hull of
    /// some.
    pub fn separates(
        &self,
        chosen: &[Generator],
        hull: &[Vector<4>],
        certifier: &mut Certifier<'_>,
    ) -> bool {
        if hull.iter().any(|v| norm(v) > FASTEST) {
            return false;
        }
        let load = Load::over(&self.problem, hull);
        let Balance::Separated(w) = balance_of(chosen, &load, certifier) else {
            return false;
        };
        let (nearest, _) = load.farthest(&w.map(|x| -x));
        let rounding: f64 = chosen.iter().map(|c| dot(&w, &c.g).max(0.0)).sum();
        dot(&nearest, &w) > self.slack + LARGEST * rounding
    }

    /// Largest |w·Σ J_kᵀ p_k| that the feet can bring about.
    pub fn friction_bound(&self, w: &Vector<3>) -> f64 {
        self.problem
            .feet
            .iter()
            .map(|foot| foot.bound * norm(&foot.slip(w)))
            .sum()
    }

    /// w·T(V) ≥ 0 at best, with the feet's friction all along w.
    pub fn most_along(&self, w: &Vector<4>) -> Inequality {
        let [x, y, turn, _] = *w;
        Inequality {
            row: [x, y, turn, 0.0],
            offset: self.load_along(w, &[0.0; 4]) + self.friction_bound(&velocity(w)),
        }
    }

    /// w·T(V) without the feet's part.
    pub fn load_along(&self, w: &Vector<4>, v: &Vector<4>) -> f64 {
        dot(
            &velocity(w),
            &add_scaled(&velocity(v), -1.0, &self.problem.free),
        ) + w[3] * self.problem.stall
    }

    /// Range of w·T(V) for V on the segment from a to b.
    pub fn range_along(&self, w: &Vector<4>, a: &Vector<4>, b: &Vector<4>) -> Interval {
        let mut range = Interval::hull(self.load_along(w, a), self.load_along(w, b));
        for foot in &self.problem.feet {
            let part = Interval::of_directions(foot.slip(w), foot.slip(a), foot.slip(b));
            range.low += foot.bound * part.low;
            range.high += foot.bound * part.high;
        }
        range
    }
}

/// Impulses of generators that balance a load.
fn balance_of(chosen: &[Generator], load: &Load<'_>, certifier: &mut Certifier<'_>) -> Balance {
    let generators: Vec<_> = chosen.iter().map(|c| c.g).collect();
    let (found, systems) = balance(&generators, load, 0.0);
    certifier.spend(systems);
    found
}
