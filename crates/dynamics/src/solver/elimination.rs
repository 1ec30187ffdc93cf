//! Gauss elimination: [`solve_three`] and [`solve_four`] of `W` systems side by side, without
//! pivoting; [`solve_dense`] of one system, with it.
//!
//! In lanes, the equations are the three momentum balances, then the stall pair, eliminated in that
//! order. The balances' matrix is the identity plus the resistance to motion, so its pivots stay
//! large however much stiffer some directions are than others; only a sliding contact may bring one
//! near zero. A bad pivot gives a bad step, which the residual test rejects. Searching for better
//! pivots costs every step a tenth and leaves as many problems of the recorded logs to the
//! homotopy.
//!
//! Written out, so that every number stays in a register.

use stickslip_lanes::Lanes;

use crate::solver::vector::add_scaled;

/// The unknowns of three equations: three coefficients each, then the right-hand side.
#[inline(always)]
pub fn solve_three<const W: usize>([a, b, c]: &[[Lanes<W>; 4]; 3]) -> [Lanes<W>; 3] {
    let [inv_a, inv_b] = inverse_pivots(a, b);
    let [b, c]: [[_; 3]; 2] = [without_first(b, a, inv_a), without_first(c, a, inv_a)];
    let c: [_; 2] = without_first(&c, &b, inv_b);

    let z = c[1] * (Lanes::splat(1.0) / c[0]);
    let y = b[2].sub_mul(b[1], z) * inv_b;
    let x = a[3].sub_mul(a[1], y).sub_mul(a[2], z) * inv_a;
    [x, y, z]
}

/// The unknowns of four equations: four coefficients each, then the right-hand side. Where the last
/// unknown is zero, the others are those of [`solve_three`] to the bit.
#[inline(always)]
pub fn solve_four<const W: usize>([a, b, c, d]: &[[Lanes<W>; 5]; 4]) -> [Lanes<W>; 4] {
    let [inv_a, inv_b] = inverse_pivots(a, b);
    let [b, c, d]: [[_; 4]; 3] = [
        without_first(b, a, inv_a),
        without_first(c, a, inv_a),
        without_first(d, a, inv_a),
    ];
    let [c, d]: [[_; 3]; 2] = [without_first(&c, &b, inv_b), without_first(&d, &b, inv_b)];
    let [inv_c, inv_d] = inverse_pivots(&c, &d);
    let d: [_; 2] = without_first(&d, &c, inv_c);

    let w = d[1] * inv_d;
    let z = c[2].sub_mul(c[1], w) * inv_c;
    let y = b[3].sub_mul(b[1], z).sub_mul(b[2], w) * inv_b;
    let x = a[4].sub_mul(a[1], y).sub_mul(a[2], z).sub_mul(a[3], w) * inv_a;
    [x, y, z, w]
}

/// The reciprocals of the first coefficient of `a`, and of the second one of `b` after `a` has
/// eliminated its first: the two divisions do not wait for each other.
#[inline(always)]
fn inverse_pivots<const N: usize, const W: usize>(
    a: &[Lanes<W>; N],
    b: &[Lanes<W>; N],
) -> [Lanes<W>; 2] {
    [
        Lanes::splat(1.0) / a[0],
        a[0] / (a[0] * b[1]).sub_mul(a[1], b[0]),
    ]
}

/// `equation` with its first unknown eliminated by `pivot`, whose first coefficient has the
/// reciprocal `inverse`; M is N − 1.
#[inline(always)]
fn without_first<const N: usize, const M: usize, const W: usize>(
    equation: &[Lanes<W>; N],
    pivot: &[Lanes<W>; N],
    inverse: Lanes<W>,
) -> [Lanes<W>; M] {
    let factor = equation[0] * inverse;
    let mut rest = [Lanes::ZERO; M];
    for k in 0..M {
        rest[k] = equation[k + 1].sub_mul(factor, pivot[k + 1]);
    }
    rest
}

/// Solves the dense N×N system m x = b by elimination with row pivoting; `None` where a pivot is at
/// most `singular` times the largest entry.
pub fn solve_dense<const N: usize>(
    m: [[f64; N]; N],
    b: [f64; N],
    singular: f64,
) -> Option<[f64; N]> {
    let solution = solve_dense_sides(m, b.map(|b| [b]), singular)?;
    Some(solution.map(|[x]| x))
}

/// [`solve_dense`] of `M` right-hand sides, the columns of `b`.
pub fn solve_dense_sides<const N: usize, const M: usize>(
    mut m: [[f64; N]; N],
    mut b: [[f64; M]; N],
    singular: f64,
) -> Option<[[f64; M]; N]> {
    let largest = m.iter().flatten().fold(0.0f64, |a, x| a.max(x.abs()));
    for c in 0..N {
        let pivot = (c..N).fold(c, |best, r| {
            if m[r][c].abs() > m[best][c].abs() {
                r
            } else {
                best
            }
        });
        m.swap(c, pivot);
        b.swap(c, pivot);
        if m[c][c].abs() <= singular * largest || !m[c][c].is_finite() {
            return None;
        }
        for r in c + 1..N {
            let f = m[r][c] / m[c][c];
            for k in c..N {
                m[r][k] -= f * m[c][k];
            }
            b[r] = add_scaled(&b[r], -f, &b[c]);
        }
    }
    for c in (0..N).rev() {
        for k in c + 1..N {
            b[c] = add_scaled(&b[c], -m[c][k], &b[k]);
        }
        b[c] = b[c].map(|x| x / m[c][c]);
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix like those of the balances: the identity, and two directions of penalty stiffness
    /// k.
    fn equations<const N: usize, const M: usize>(k: f64) -> [[f64; M]; N] {
        let stiff = |i: usize, j: usize| {
            libm::sin((i + 1) as f64) * libm::sin((j + 1) as f64) + 0.3 * libm::cos((i * j) as f64)
        };
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                if j == N {
                    1.0 + i as f64
                } else {
                    f64::from(u8::from(i == j)) + k * stiff(i, j)
                }
            })
        })
    }

    #[track_caller]
    fn agrees<const N: usize, const M: usize>(
        equations: [[f64; M]; N],
        found: [Lanes<1>; N],
        accuracy: f64,
    ) {
        let matrix = equations.map(|row| std::array::from_fn(|j| row[j]));
        let exact =
            solve_dense(matrix, equations.map(|row| row[N]), 0.0).expect("a regular matrix");
        for (found, exact) in found.iter().zip(exact) {
            assert!(
                (found.0[0] - exact).abs() <= accuracy * exact.abs(),
                "{}, not {exact}",
                found.0[0]
            );
        }
    }

    #[test]
    fn unknowns_agree_with_elimination_with_pivots_up_to_stiff_rows() {
        for (k, accuracy) in [(0.0, 1e-15), (1.0, 1e-13), (1e4, 1e-10), (1e8, 1e-6)] {
            let (three, four) = (equations::<3, 4>(k), equations::<4, 5>(k));
            agrees(
                three,
                solve_three(&three.map(|row| row.map(|x| Lanes([x])))),
                accuracy,
            );
            agrees(
                four,
                solve_four(&four.map(|row| row.map(|x| Lanes([x])))),
                accuracy,
            );
        }
    }
}
