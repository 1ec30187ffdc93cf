//! The velocities that three generators allow whose equations depend on each other:
//! [`RedundantPlane`].

use crate::solver::exhaustive::certifier::Certifier;
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::ModeConditions;
use crate::solver::exhaustive::piece_search::{Finding, NARROWEST, Thoroughness, WIDTHS};
use crate::solver::exhaustive::plane_region::PlaneRegion;
use crate::solver::exhaustive::subspace::Equation;
use crate::solver::vector::{Vector, dot, norm};

/// The part of a plane on which impulses α ≥ 0 of three generators may balance the load, with
/// nothing left along the fourth vector of the dual basis.
pub struct RedundantPlane<'a> {
    conditions: &'a ModeConditions,
    chosen: &'a [Generator; 3],
    region: PlaneRegion,
    /// Dual basis of the generators and of the vector orthogonal to them.
    dual: [Vector<4>; 4],
}

impl<'a> RedundantPlane<'a> {
    /// `None` where no two equations leave a plane.
    pub fn new(
        conditions: &'a ModeConditions,
        chosen: &'a [Generator; 3],
        dual: [Vector<4>; 4],
    ) -> Option<Self> {
        let mut region = PlaneRegion::new(&least_parallel(&conditions.equations(chosen)))?;
        // all equations and inequalities, and what the feet can make up for
        let [a, b, c, along_m] = dual;
        let balances = [a, b, c, along_m, along_m.map(|x| -x)].map(|w| conditions.most_along(&w));
        let equations = conditions.both_sides(chosen);
        let inequalities = conditions.inequalities(chosen);
        for inequality in equations.into_iter().chain(inequalities).chain(balances) {
            region.clip(&inequality, conditions.slack);
        }
        Some(Self {
            conditions,
            chosen,
            region,
            dual,
        })
    }

    /// Halves the region until every part is excluded or a candidate is certified; gives up after
    /// so many parts, or where no work is left.
    pub fn search(self, thoroughness: Thoroughness, certifier: &mut Certifier<'_>) -> Finding {
        let mut finding = Finding::Excluded;
        let mut attempts = [thoroughness.attempts; WIDTHS.len()];
        let mut stack = vec![self.region.clone()];
        for part in 0.. {
            let Some(region) = stack.pop() else {
                break;
            };
            if region.is_empty() {
                continue;
            }
            if part == thoroughness.pieces || certifier.left() == 0 {
                return Finding::Unclear;
            }
            certifier.spend(1);
            if self.excludes(&region, thoroughness, certifier) {
                continue;
            }
            let middle = region.middle();
            let width = region.width() / (1.0 + norm(&middle));
            if let Some(k) = WIDTHS.iter().rposition(|limit| width < *limit)
                && attempts[k] > 0
            {
                attempts[k] -= 1;
                let alpha = [0, 1, 2].map(|i| {
                    let range = self.conditions.range_along(&self.dual[i], &middle, &middle);
                    range.midpoint()
                });
                let stands = thoroughness.stands;
                if self
                    .conditions
                    .solves(self.chosen, &alpha, &middle, stands, certifier)
                {
                    return Finding::Solved;
                }
            }
            if width < NARROWEST {
                finding = Finding::Unclear;
                continue;
            }
            stack.extend(region.halves());
        }
        finding
    }

    /// Returns true if no V of a part has impulses that are positive and balance the load.
    fn excludes(
        &self,
        part: &PlaneRegion,
        thoroughness: Thoroughness,
        certifier: &mut Certifier<'_>,
    ) -> bool {
        let corners: Vec<_> = part.corners().collect();
        let slack = self.conditions.slack;
        let [a, b, c, along_m] = self.dual.map(|w| self.conditions.range_over(&w, &corners));
        let balances = along_m.low <= slack && along_m.high >= -slack;
        !balances
            || !self.conditions.allows(&[a, b, c])
            || thoroughness.separates && self.conditions.separates(self.chosen, &corners, certifier)
    }
}

/// The two of three equations whose rows are farthest from parallel.
fn least_parallel(equations: &[Equation; 3]) -> [Equation; 2] {
    let parallel =
        |[a, b]: &[Equation; 2]| dot(&a.row, &b.row).abs() / (norm(&a.row) * norm(&b.row));
    let [a, b, c] = *equations;
    let mut best = [a, b];
    for pair in [[a, c], [b, c]] {
        if parallel(&pair) < parallel(&best) {
            best = pair;
        }
    }
    best
}

impl ModeConditions {
    /// Range of w·T(V) for V in a convex polygon with these corners.
    fn range_over(&self, w: &Vector<4>, corners: &[Vector<4>]) -> Interval {
        let edges = || (0..corners.len()).map(|k| [&corners[k], &corners[(k + 1) % corners.len()]]);
        let mut range = hull(corners.iter().map(|v| {
            let load = self.load_along(w, v);
            Interval::hull(load, load)
        }));
        for foot in &self.problem.feet {
            let cross = |[a, b]: [&Vector<4>; 2]| {
                let ([ax, ay], [bx, by]) = (foot.slip(a), foot.slip(b));
                ax * by - ay * bx
            };
            let [left, right] =
                [1.0, -1.0].map(|sign| edges().all(|edge| sign * cross(edge) >= 0.0));
            let part = if left || right {
                // the foot may stand in the polygon
                let size = norm(&foot.slip(w));
                Interval::hull(-size, size)
            } else {
                hull(edges().map(|[a, b]| {
                    Interval::of_directions(foot.slip(w), foot.slip(a), foot.slip(b))
                }))
            };
            range.low += foot.bound * part.low;
            range.high += foot.bound * part.high;
        }
        range
    }
}

/// The least interval that contains all given ones.
fn hull(intervals: impl Iterator<Item = Interval>) -> Interval {
    let none = Interval {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };
    intervals.fold(none, |all, one| Interval {
        low: all.low.min(one.low),
        high: all.high.max(one.high),
    })
}
