//! Points, lines and dual bases in the space of (v, y), for the search over contact modes:
//! [`Equation`].

use crate::solver::elimination::{solve_dense, solve_dense_sides};
use crate::solver::vector::{Vector, add_scaled, dot, norm};

/// Pivots below this share of the largest entry make vectors dependent.
pub const DEPENDENT: f64 = 1e-13;

/// A linear condition row·V = value.
#[derive(Clone, Copy, Debug)]
pub struct Equation {
    /// Coefficients.
    pub row: Vector<4>,
    /// Right-hand side.
    pub value: f64,
}

/// A unit vector orthogonal to three vectors; `None` where they are dependent.
pub fn null_vector(rows: &[Vector<4>; 3]) -> Option<Vector<4>> {
    let d = cross(rows);
    let size = norm(&d);
    (size > 1e-12 * scale(rows)).then(|| d.map(|x| x / size))
}

/// Distance of three vectors from linear dependence: 0 where they are dependent, 1 where they are
/// orthogonal.
pub fn independence(rows: &[Vector<4>; 3]) -> f64 {
    norm(&cross(rows)) / scale(rows)
}

fn scale(rows: &[Vector<4>; 3]) -> f64 {
    rows.iter().map(norm).product()
}

/// The vector orthogonal to three vectors, as long as the volume that they span.
fn cross(rows: &[Vector<4>; 3]) -> Vector<4> {
    let minor = |skip: usize| {
        let pick = |r: &Vector<4>| -> [f64; 3] {
            std::array::from_fn(|j| r[if j < skip { j } else { j + 1 }])
        };
        let [a, b, c] = [pick(&rows[0]), pick(&rows[1]), pick(&rows[2])];
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    [minor(0), -minor(1), minor(2), -minor(3)]
}

/// Rows w_j with w_j·g_k = 1 where j = k, else 0; `None` where the vectors are dependent.
pub fn dual_basis(g: &[Vector<4>; 4]) -> Option<[Vector<4>; 4]> {
    // the inverse, whose columns they are
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    let sides = std::array::from_fn(|i| std::array::from_fn(|j| unit(i, j)));
    let inverse: [Vector<4>; 4] = solve_dense_sides(*g, sides, DEPENDENT)?;
    Some(std::array::from_fn(|j| inverse.map(|row| row[j])))
}

/// The V of least length that best satisfies the equations.
pub fn least_squares<const N: usize>(equations: &[Equation; N]) -> Vector<4> {
    // (A Aᵀ + tiny) z = b, V = Aᵀ z; two refinements remove the effect of tiny
    let gram: [[f64; N]; N] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            dot(&equations[i].row, &equations[j].row) + if i == j { 1e-12 } else { 0.0 }
        })
    });
    let mut v = [0.0; 4];
    for _ in 0..3 {
        let miss: [f64; N] =
            std::array::from_fn(|i| equations[i].value - dot(&equations[i].row, &v));
        let Some(z) = solve_dense(gram, miss, 0.0) else {
            break;
        };
        for (e, z) in equations.iter().zip(z) {
            v = add_scaled(&v, z, &e.row);
        }
    }
    v
}
