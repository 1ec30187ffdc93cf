//! The part of a plane of V = (v, y) where linear inequalities hold: [`PlaneRegion`].

use crate::solver::mode_conditions::Inequality;
use crate::solver::subspace::Equation;
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Half the edge of the square from which a region is cut (m/s): no solution is faster.
const FARTHEST: f64 = 1e6;

/// What is left of a unit vector across another below which the two are parallel.
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
            corners: square.map(|p: [f64; 2]| p.map(|x| FARTHEST * x)).to_vec(),
        })
    }

    /// Removes the points where row·V + offset < −slack.
    pub fn clip(&mut self, Inequality { row, offset }: &Inequality, slack: f64) {
        let constant = dot(row, &self.origin) + offset + slack;
        let slope = self.axes.map(|axis| dot(row, &axis));
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

    /// Whether no point is left.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }
}

/// Two directions that, with two others, span the space; `None` where those are parallel.
pub fn complement(a: &Vector<4>, b: &Vector<4>) -> Option<[Vector<4>; 2]> {
    let along = direction_across(a, &[])?;
    let across = direction_across(b, &[along])?;
    let third = most_across(&[along, across])?;
    Some([third, most_across(&[along, across, third])?])
}

/// The unit vector of what of `v` is orthogonal to an orthonormal basis; `None` where next to
/// nothing is.
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
