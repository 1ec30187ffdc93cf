//! The inverse of small matrices, `W` side by side: [`Inverse`].

use crate::lanes::Lanes;
use crate::ncp::{Triple, dot};

/// The inverse of a 3×3 matrix, by its cofactors: short chains of operations, where elimination with pivots has long ones.
pub struct Inverse<const W: usize> {
    matrix: [Triple<W>; 3],
    cofactors: [Triple<W>; 3],
    over_determinant: Lanes<W>,
}

impl<const W: usize> Inverse<W> {
    #[inline(always)]
    pub fn of(matrix: [Triple<W>; 3]) -> Self {
        let [a, b, c] = &matrix;
        let cofactors = [cross(b, c), cross(c, a), cross(a, b)];
        let over_determinant = Lanes::splat(1.0) / dot(a, &cofactors[0]);
        Self { matrix, cofactors, over_determinant }
    }

    /// A⁻¹ b. Some directions are held a million times stiffer than others, and cofactors cancel there: one refinement makes the
    /// result as good as elimination's.
    #[inline(always)]
    pub fn apply(&self, b: &Triple<W>) -> Triple<W> {
        let x = self.roughly(b);
        let mut miss = *b;
        for (miss, row) in miss.iter_mut().zip(&self.matrix) {
            *miss -= dot(row, &x);
        }
        let correction = self.roughly(&miss);
        [x[0] + correction[0], x[1] + correction[1], x[2] + correction[2]]
    }

    #[inline(always)]
    fn roughly(&self, b: &Triple<W>) -> Triple<W> {
        let [p, q, r] = &self.cofactors;
        let mut x = [Lanes::ZERO; 3];
        for (i, x) in x.iter_mut().enumerate() {
            *x = (p[i] * b[0] + q[i] * b[1] + r[i] * b[2]) * self.over_determinant;
        }
        x
    }
}

#[inline(always)]
fn cross<const W: usize>(a: &Triple<W>, b: &Triple<W>) -> Triple<W> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
