//! Random numbers of tests: [`Numbers`].

use crate::solver::vector::Vector;

/// Uniform numbers in [−1, 1], by a linear congruence.
pub struct Numbers(pub u64);

impl Numbers {
    /// The next one.
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// The next N.
    pub fn vector<const N: usize>(&mut self) -> Vector<N> {
        [0.0; N].map(|_| self.next())
    }
}
