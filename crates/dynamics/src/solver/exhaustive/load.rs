//! Load that contacts have to balance: [`Load`].

use crate::solver::exhaustive::scalar_ncp::{ScalarFoot, ScalarNcp};
use crate::solver::vector::{Vector, add_scaled, dot, norm, velocity};

/// Slip below which rounding may turn its direction (m/s, relative to V where above 1).
const CREEPS: f64 = 1e-6;

/// T(V) for all V of a convex set, with feet that slip in any direction there, or stand: the hull
/// of some corners, plus Σ b_k J_kᵀ u_k with |u_k| ≤ 1.
#[derive(Clone, Debug)]
pub struct Load<'a> {
    /// Without the feet whose slip is not known.
    pub corners: Vec<Vector<4>>,
    /// The feet.
    pub feet: &'a [ScalarFoot; 3],
    /// Slip of each foot.
    pub slips: [Slips; 3],
}

/// Directions in which a foot may slip.
#[derive(Clone, Copy, Debug)]
pub enum Slips {
    /// As the corners have it.
    Known,
    /// In a direction from one unit vector to another one to its left, by less than half a turn.
    Between([f64; 2], [f64; 2]),
    /// In any direction, or not at all.
    Any,
}

impl<'a> Load<'a> {
    /// At V = (v, y) of a problem, whose other feet slide; a rigid pusher adds nothing.
    pub fn at(problem: &'a ScalarNcp, v: &Vector<4>, stands: [bool; 3]) -> Self {
        let sliding = problem
            .feet
            .iter()
            .zip(stands)
            .filter(|(_, stands)| !stands);
        let corner = sliding.fold(without_feet(problem, v), |corner, (foot, _)| {
            add_scaled(&corner, -1.0, &wrench(foot, &foot.sliding(v)))
        });
        let slips = |stands| if stands { Slips::Any } else { Slips::Known };
        Self {
            corners: vec![corner],
            feet: &problem.feet,
            slips: stands.map(slips),
        }
    }

    /// For all V of the hull of some.
    pub fn over(problem: &'a ScalarNcp, hull: &[Vector<4>]) -> Self {
        let fastest = hull.iter().map(norm).fold(1.0, f64::max);
        let slips = |foot: ScalarFoot| {
            let corners: Vec<_> = hull.iter().map(|v| foot.slip(v)).collect();
            Slips::between(&corners, CREEPS * fastest)
        };
        Self {
            corners: hull.iter().map(|v| without_feet(problem, v)).collect(),
            feet: &problem.feet,
            slips: problem.feet.map(slips),
        }
    }

    /// The point that lies farthest along w, and its u.
    pub fn farthest(&self, w: &Vector<4>) -> (Vector<4>, [[f64; 2]; 3]) {
        let corners = self.corners.iter().map(|corner| (corner, dot(corner, w)));
        let first = (&self.corners[0], f64::NEG_INFINITY);
        let (corner, _) = corners.fold(first, |a, b| if b.1 > a.1 { b } else { a });
        let (mut point, mut directions) = (*corner, [[0.0; 2]; 3]);
        for ((foot, slips), u) in self.feet.iter().zip(self.slips).zip(&mut directions) {
            *u = slips.farthest(foot.slip(w));
            point = add_scaled(&point, foot.bound, &wrench(foot, u));
        }
        (point, directions)
    }

    /// No point is longer.
    pub fn size(&self) -> f64 {
        let foot = |foot: &ScalarFoot| foot.bound * (1.0 + norm(&[foot.jx, foot.jy]));
        let corner = self.corners.iter().map(norm).fold(0.0, f64::max);
        corner + self.feet.iter().map(foot).sum::<f64>()
    }
}

impl Slips {
    /// In the hull of some velocities; any where one is no faster than `creeps`.
    fn between(velocities: &[[f64; 2]], creeps: f64) -> Self {
        let (mut right, mut left) = (velocities[0], velocities[0]);
        for s in velocities {
            if cross(right, *s) < 0.0 {
                right = *s;
            }
            if cross(left, *s) > 0.0 {
                left = *s;
            }
        }
        let [right, left] = [right, left].map(|s| s.map(|x| x / norm(&s)));
        let middle = add_scaled(&right, 1.0, &left);
        let is_between = |s: &[f64; 2]| {
            let in_order = cross(right, *s) >= 0.0 && cross(*s, left) >= 0.0;
            in_order && dot(&middle, s) > 0.0 && norm(s) > creeps
        };
        if velocities.iter().all(is_between) {
            Self::Between(right, left)
        } else {
            Self::Any
        }
    }

    /// The direction that lies farthest along q; zero where it is known.
    fn farthest(&self, q: [f64; 2]) -> [f64; 2] {
        let size = norm(&q);
        match *self {
            Self::Between(right, left) if cross(right, q) < 0.0 || cross(q, left) < 0.0 => {
                if dot(&right, &q) > dot(&left, &q) {
                    right
                } else {
                    left
                }
            }
            Self::Between(..) | Self::Any if size > 0.0 => q.map(|x| x / size),
            _ => [0.0; 2],
        }
    }
}

/// (v − v_free, F_stall h / m).
fn without_feet(problem: &ScalarNcp, v: &Vector<4>) -> Vector<4> {
    let [x, y, turn] = add_scaled(&velocity(v), -1.0, &problem.free);
    let stall = Some(problem.stall).filter(|stall| stall.is_finite());
    [x, y, turn, stall.unwrap_or(0.0)]
}

/// J_kᵀ p.
fn wrench(foot: &ScalarFoot, p: &[f64; 2]) -> Vector<4> {
    [p[0], p[1], foot.jx * p[0] + foot.jy * p[1], 0.0]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::exhaustive::numbers::Numbers;

    fn random_problem(numbers: &mut Numbers) -> ScalarNcp {
        ScalarNcp {
            free: numbers.vector(),
            feet: [0; 3].map(|_| ScalarFoot {
                jx: numbers.next(),
                jy: numbers.next(),
                bound: numbers.next().abs(),
            }),
            stall: numbers.next().abs(),
            ..ScalarNcp::default()
        }
    }

    /// T(V) of any V between the corners is in the set, by its definition with feet that slide.
    /// Directions are distinguished wherever all corners slip alike.
    #[test]
    fn load_over_a_hull_holds_the_load_of_each_of_its_velocities() {
        let (mut numbers, mut told) = (Numbers(3), 0);
        for round in 0..2000 {
            let problem = random_problem(&mut numbers);
            let middle: Vector<4> = numbers.vector();
            let reach = [0.01, 0.3, 2.0][round % 3];
            let hull = [0; 4].map(|_| add_scaled(&middle, reach, &numbers.vector()));
            let load = Load::over(&problem, &hull);
            told += usize::from(matches!(load.slips[0], Slips::Between(..)));
            for _ in 0..10 {
                let shares = [0; 4].map(|_| numbers.next().abs());
                let total: f64 = shares.iter().sum();
                let v = shares
                    .iter()
                    .zip(&hull)
                    .fold([0.0; 4], |v, (share, corner)| {
                        add_scaled(&v, share / total, corner)
                    });
                let exact = Load::at(&problem, &v, [false; 3]).corners[0];
                let w = numbers.vector();
                let (farthest, _) = load.farthest(&w);
                assert!(dot(&w, &exact) <= dot(&w, &farthest) + 1e-12, "{load:?}");
            }
        }
        assert!((600..1900).contains(&told), "{told}");
    }

    #[test]
    fn slips_all_around_or_at_rest_are_of_any_direction() {
        let around = [[1.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]];
        assert!(matches!(Slips::between(&around, 1e-6), Slips::Any));
        let opposite = [[1.0, 0.0], [-1.0, 0.0]];
        assert!(matches!(Slips::between(&opposite, 1e-6), Slips::Any));
        let rests = [[1.0, 0.0], [0.0, 0.0]];
        assert!(matches!(Slips::between(&rests, 1e-6), Slips::Any));
        // a quarter turn, in any order
        let quarter = [[0.0, 2.0], [1.0, 1.0], [3.0, 0.0]];
        let slips = Slips::between(&quarter, 1e-6);
        assert!(
            matches!(slips, Slips::Between([1.0, 0.0], [0.0, 1.0])),
            "{slips:?}"
        );
        assert_eq!(slips.farthest([-1.0, 0.5]), [0.0, 1.0]);
    }
}
