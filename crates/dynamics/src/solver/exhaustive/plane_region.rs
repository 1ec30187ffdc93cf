//! The part of a plane of V = (v, y) where linear inequalities hold: [`PlaneRegion`].

use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::Inequality;
use crate::solver::exhaustive::piece_search::FARTHEST;
use crate::solver::exhaustive::subspace::Equation;
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Part of a unit vector across another below which the two are parallel.
const PARALLEL: f64 = 1e-9;

/// A convex polygon in the plane V = origin + a e₁ + b e₂; empty without corners.
#[derive(Clone, Debug)]
pub struct PlaneRegion {
    origin: Vector<4>,
    axes: [Vector<4>; 2],
    corners: Vec<[f64; 2]>,
}

impl PlaneRegion {
    /// All of the plane that two equations leave; `None` where their rows are parallel.
    pub fn new([first, second]: &[Equation; 2]) -> Option<Self> {
        // along the two rows
        let along = direction_across(&first.row, &[])?;
        let across = direction_across(&second.row, &[along])?;
        let a = first.value / dot(&first.row, &along);
        let b = (second.value - a * dot(&second.row, &along)) / dot(&second.row, &across);
        // across them
        let third = most_across(&[along, across])?;
        let fourth = most_across(&[along, across, third])?;
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        Some(Self {
            origin: add_scaled(&along.map(|x| a * x), b, &across),
            axes: [third, fourth],
            // a square that no solution lies outside of
            corners: square.map(|p: [f64; 2]| p.map(|x| FARTHEST * x)).to_vec(),
        })
    }

    /// Removes the points where row·V + offset < −slack.
    pub fn clip(&mut self, Inequality { row, offset }: &Inequality, slack: f64) {
        let constant = dot(row, &self.origin) + offset + slack;
        self.cut(self.axes.map(|axis| dot(row, &axis)), constant);
    }

    /// Removes the points where slope·(a, b) + constant < 0.
    fn cut(&mut self, slope: [f64; 2], constant: f64) {
        let value = |[a, b]: [f64; 2]| constant + slope[0] * a + slope[1] * b;
        if self.corners.iter().all(|corner| value(*corner) >= 0.0) {
            return;
        }
        let mut left = Vec::with_capacity(self.corners.len() + 1);
        for (k, p) in self.corners.iter().enumerate() {
            let q = self.corners[(k + 1) % self.corners.len()];
            let (at_p, at_q) = (value(*p), value(q));
            if at_p >= 0.0 {
                left.push(*p);
            }
            if (at_p >= 0.0) != (at_q >= 0.0) {
                let share = at_p / (at_p - at_q);
                left.push([0, 1].map(|i| p[i] + share * (q[i] - p[i])));
            }
        }
        self.corners = left;
    }

    /// Returns true if no point is left.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Its corners.
    pub fn corners(&self) -> impl Iterator<Item = Vector<4>> + '_ {
        self.corners.iter().map(|corner| self.at(*corner))
    }

    /// The middle of the box about it, which need not be within it.
    pub fn middle(&self) -> Vector<4> {
        self.at([0, 1].map(|k| self.side(k).midpoint()))
    }

    /// The longer side of that box.
    pub fn width(&self) -> f64 {
        let length = |k: usize| self.side(k).high - self.side(k).low;
        length(0).max(length(1))
    }

    /// Its two parts on either side of the middle of the longer side.
    pub fn halves(&self) -> [Self; 2] {
        let sides = [0, 1].map(|k| self.side(k));
        let lengths = sides.map(|side| side.high - side.low);
        let longer = usize::from(lengths[1] > lengths[0]);
        let middle = sides[longer].midpoint();
        [1.0, -1.0].map(|sign| {
            let mut slope = [0.0; 2];
            slope[longer] = sign;
            let mut half = self.clone();
            half.cut(slope, -sign * middle);
            half
        })
    }

    /// Range of one coordinate.
    fn side(&self, k: usize) -> Interval {
        let empty = Interval {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        self.corners.iter().fold(empty, |side, corner| Interval {
            low: side.low.min(corner[k]),
            high: side.high.max(corner[k]),
        })
    }

    fn at(&self, [a, b]: [f64; 2]) -> Vector<4> {
        add_scaled(
            &add_scaled(&self.origin, a, &self.axes[0]),
            b,
            &self.axes[1],
        )
    }
}

/// Two directions that, with two others, span the space; `None` where those are parallel.
pub fn complement(a: &Vector<4>, b: &Vector<4>) -> Option<[Vector<4>; 2]> {
    let along = direction_across(a, &[])?;
    let across = direction_across(b, &[along])?;
    let third = most_across(&[along, across])?;
    Some([third, most_across(&[along, across, third])?])
}

/// The unit vector along the part of `v` that is orthogonal to an orthonormal basis; `None` where
/// that part is next to nothing.
fn direction_across(v: &Vector<4>, basis: &[Vector<4>]) -> Option<Vector<4>> {
    let size = norm(v);
    // twice, against rounding
    let mut rest = *v;
    for unit in basis.iter().chain(basis) {
        rest = add_scaled(&rest, -dot(&rest, unit), unit);
    }
    let length = norm(&rest);
    (length > PARALLEL * size).then(|| rest.map(|x| x / length))
}

/// A unit vector orthogonal to an orthonormal basis: of the coordinate axis that lies farthest from
/// it.
fn most_across(basis: &[Vector<4>]) -> Option<Vector<4>> {
    let within = |k: usize| basis.iter().map(|unit| unit[k] * unit[k]).sum::<f64>();
    let farthest = (0..4).min_by(|a, b| within(*a).total_cmp(&within(*b)))?;
    let mut axis = [0.0; 4];
    axis[farthest] = 1.0;
    direction_across(&axis, basis)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plane v_x + v_y = 1, y = 2, cut to v_x ≥ 0 and v_y ≥ 0, and then to nothing.
    #[test]
    fn region_keeps_what_the_inequalities_allow() {
        let equations = [
            Equation {
                row: [1.0, 1.0, 0.0, 0.0],
                value: 1.0,
            },
            Equation {
                row: [0.0, 0.0, 0.0, 3.0],
                value: 6.0,
            },
        ];
        let mut region = PlaneRegion::new(&equations).expect("two directions");
        let at_least = |row: Vector<4>, offset: f64| Inequality { row, offset };
        region.clip(&at_least([1.0, 0.0, 0.0, 0.0], 0.0), 0.0);
        region.clip(&at_least([0.0, 1.0, 0.0, 0.0], 0.0), 0.0);
        region.clip(&at_least([0.0, 0.0, 0.0, 1.0], -2.0), 1e-12);
        assert!(!region.is_empty());
        region.clip(&at_least([-1.0, -1.0, 0.0, 0.0], 0.5), 0.4);
        assert!(region.is_empty());
    }

    /// Halves of halves cover the region, each half as wide as the one before or less.
    #[test]
    fn halves_cover_the_region() {
        let unit = |k: usize| {
            let mut row = [0.0; 4];
            row[k] = 1.0;
            row
        };
        let equations = [0, 1].map(|k| Equation {
            row: unit(k),
            value: 0.0,
        });
        let mut region = PlaneRegion::new(&equations).expect("two directions");
        for k in [2, 3] {
            for sign in [1.0, -1.0] {
                let inequality = Inequality {
                    row: unit(k).map(|x| -sign * x),
                    offset: k as f64,
                };
                region.clip(&inequality, 0.0);
            }
        }
        // a rectangle of 4 by 6
        assert_eq!(region.width(), 6.0);
        let [low, high] = region.halves();
        assert_eq!((low.width(), high.width()), (4.0, 4.0));
        let corners: Vec<_> = low.corners().chain(high.corners()).collect();
        for (x, y) in [(2.0, 3.0), (-2.0, 3.0), (2.0, -3.0), (-2.0, -3.0)] {
            assert!(corners.contains(&[0.0, 0.0, x, y]), "{corners:?}");
        }
    }

    #[test]
    fn parallel_equations_leave_no_plane() {
        let row = [0.3, -0.4, 0.5, 0.1];
        let equations = [1.0, -2.0].map(|s: f64| Equation {
            row: row.map(|x| s * x),
            value: 1.0,
        });
        assert!(PlaneRegion::new(&equations).is_none());
    }
}
