//! The point of a convex set that is nearest to the origin: [`nearest_in_hull`].

use nalgebra::{DMatrix, DVector, SVD};

/// Lean of a column on the rest, per its length, that is rounding.
const ROUNDING: f64 = 1e-13;

/// The sum of the columns of `points`, weighted, and of `rays` that is nearest to the origin,
/// weights not negative and those of the points summing to one.
///
/// By Haskell and Hanson (1981): least squares with weights that are not negative, for one more
/// row, of ones in points and of zeros in rays, whose target is one. Those by the active set of
/// Lawson and Hanson (1974), which ends at the optimum but for rounding.
pub(crate) fn nearest_in_hull<const N: usize>(points: &[[f64; N]], rays: &[[f64; N]]) -> [f64; N] {
    let count = points.len() + rays.len();
    let matrix = DMatrix::from_fn(N + 1, count, |row, j| match points.get(j) {
        Some(point) => point.get(row).copied().unwrap_or(1.0),
        None => rays[j - points.len()].get(row).copied().unwrap_or(0.0),
    });
    let target = DVector::from_fn(N + 1, |row, _| f64::from(u8::from(row == N)));
    let weights = nonnegative_least_squares(&matrix, &target);
    let total: f64 = weights.iter().take(points.len()).sum();
    let sum = matrix * weights / total;
    std::array::from_fn(|row| sum[row])
}

/// x ≥ 0 with the least |A x − b|.
fn nonnegative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let mut x = DVector::zeros(a.ncols());
    let (mut active, mut useless): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    for _ in 0..10 * a.ncols() {
        let lean = a.tr_mul(&(b - a * &x));
        let relative = |j: &usize| lean[*j] / a.column(*j).norm();
        let best = (0..a.ncols())
            .filter(|j| !active.contains(j) && !useless.contains(j))
            .max_by(|i, j| relative(i).total_cmp(&relative(j)));
        let Some(best) = best.filter(|j| relative(j) > ROUNDING) else {
            break;
        };
        active.push(best);
        settle(a, b, &mut active, &mut x);
        if active.contains(&best) {
            useless.clear();
        } else {
            // but for rounding it leans on nothing
            useless.push(best);
        }
    }
    x
}

/// Moves to the best weights of the active columns, and drops those that would become negative.
fn settle(a: &DMatrix<f64>, b: &DVector<f64>, active: &mut Vec<usize>, x: &mut DVector<f64>) {
    while let Some(wanted) = unconstrained(a, b, active) {
        let negative = active.iter().zip(&wanted).filter(|(_, w)| **w <= 0.0);
        let share = negative
            .map(|(j, w)| x[*j] / (x[*j] - w).max(f64::MIN_POSITIVE))
            .reduce(f64::min);
        for (j, w) in active.iter().zip(&wanted) {
            x[*j] += share.unwrap_or(1.0) * (w - x[*j]);
        }
        if share.is_none() {
            return;
        }
        active.retain(|j| x[*j] > f64::MIN_POSITIVE);
        x.iter_mut().for_each(|x| *x = x.max(0.0));
        if active.is_empty() {
            return;
        }
    }
}

/// The weights of some columns that meet b best, the others zero.
fn unconstrained(a: &DMatrix<f64>, b: &DVector<f64>, active: &[usize]) -> Option<Vec<f64>> {
    let svd = SVD::new(a.select_columns(active), true, true);
    let solved = svd.solve(b, 1e-14).ok()?;
    Some(solved.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::SplitMix64;

    #[track_caller]
    fn nearest_is(points: &[[f64; 2]], rays: &[[f64; 2]], expected: [f64; 2]) {
        let found = nearest_in_hull(points, rays);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
        }
    }

    #[test]
    fn nearest_points_of_triangles_are_a_corner_a_foot_of_a_side_and_the_origin() {
        nearest_is(&[[1.0, 2.0], [3.0, 2.0], [2.0, 5.0]], &[], [1.0, 2.0]);
        nearest_is(&[[-1.0, 2.0], [3.0, 2.0], [2.0, 5.0]], &[], [0.0, 2.0]);
        nearest_is(&[[-1.0, -1.0], [3.0, -1.0], [0.0, 5.0]], &[], [0.0, 0.0]);
    }

    #[test]
    fn ray_extends_a_point_to_a_half_line() {
        nearest_is(&[[-3.0, 1.0]], &[[1.0, 0.0]], [0.0, 1.0]);
        nearest_is(&[[3.0, 1.0]], &[[1.0, 0.0]], [3.0, 1.0]);
    }

    /// The plane through the nearest point, across it, has all points beyond it and no ray against
    /// it.
    #[test]
    fn nearest_points_of_random_hulls_separate_them_from_the_origin() {
        let (mut rng, mut apart) = (SplitMix64::new(7), 0);
        for _ in 0..500 {
            let mut vector = || [(); 4].map(|()| rng.within(-1.0, 1.0));
            let ray = vector();
            let points: Vec<_> = (0..6).map(|_| vector()).collect();
            let nearest = nearest_in_hull(&points, &[ray]);
            let dot = |p: &[f64; 4]| p.iter().zip(&nearest).map(|(a, b)| a * b).sum::<f64>();
            let squared = dot(&nearest);
            assert!(
                points.iter().all(|p| dot(p) > squared - 1e-12),
                "{nearest:?}"
            );
            assert!(dot(&ray) > -1e-12, "{nearest:?}");
            apart += usize::from(squared > 1e-6);
        }
        assert!(apart > 100, "{apart} hulls without the origin");
    }
}
