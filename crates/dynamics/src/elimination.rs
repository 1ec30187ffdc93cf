//! Gauss elimination, `W` systems side by side: [`Elimination`].

use crate::lanes::{Lanes, Mask};

/// Four equations in four unknowns.
///
/// Elimination with row pivoting stays accurate where some directions are held a billion times stiffer than others.
pub struct Elimination<const W: usize> {
    /// Coefficients.
    pub matrix: [[Lanes<W>; 4]; 4],
    /// Right-hand sides.
    pub rhs: [Lanes<W>; 4],
}

impl<const W: usize> Elimination<W> {
    /// The unknowns.
    #[inline(always)]
    pub fn solve(mut self) -> [Lanes<W>; 4] {
        let inverse = self.eliminate();
        let mut x = self.rhs;
        for c in (0..4).rev() {
            for k in c + 1..4 {
                let known = x[k];
                x[c] -= self.matrix[c][k] * known;
            }
            x[c] = x[c] * inverse[c];
        }
        x
    }

    /// Makes the matrix upper triangular; one over its diagonal.
    #[inline(always)]
    fn eliminate(&mut self) -> [Lanes<W>; 4] {
        let mut inverse = [Lanes::ZERO; 4];
        for c in 0..4 {
            for r in c + 1..4 {
                let larger = self.matrix[r][c].abs().gt(self.matrix[c][c].abs());
                self.swap_rows(c, r, larger);
            }
            inverse[c] = Lanes::splat(1.0) / self.matrix[c][c];
            for r in c + 1..4 {
                let factor = self.matrix[r][c] * inverse[c];
                for k in c + 1..4 {
                    self.matrix[r][k] -= factor * self.matrix[c][k];
                }
                self.rhs[r] -= factor * self.rhs[c];
            }
        }
        inverse
    }

    /// Swaps rows i < j, from column i on, where `mask` holds.
    #[inline(always)]
    fn swap_rows(&mut self, i: usize, j: usize, mask: Mask<W>) {
        let swapped = |a: Lanes<W>, b: Lanes<W>| (mask.select(b, a), mask.select(a, b));
        for k in i..4 {
            (self.matrix[i][k], self.matrix[j][k]) = swapped(self.matrix[i][k], self.matrix[j][k]);
        }
        (self.rhs[i], self.rhs[j]) = swapped(self.rhs[i], self.rhs[j]);
    }
}
