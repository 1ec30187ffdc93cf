//! Gauss elimination, `W` systems side by side: [`Elimination`].

use crate::lanes::Lanes;

/// Four equations in four unknowns: three momentum balances, and the stall pair last.
///
/// They are eliminated as they stand. The balances' matrix is the identity and what resists motion, whose pivots stay large,
/// however much stiffer some directions are held than others; only a sliding contact may bring one near zero. Such a step is badly
/// off, and it is for the certificate to say so: looking for better pivots costs every step a tenth and leaves as many problems
/// of the recorded logs to the homotopy.
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
}
