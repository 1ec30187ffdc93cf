//! Linear complementarity problems, dense, and Lemke's method (Cottle, Pang & Stone, *The Linear
//! Complementarity Problem*, 1992, algorithm 4.4.5) with the lexicographic ratio test: [`Lcp`].

/// Entries of a column up to this cannot be pivots.
const LEAST_PIVOT: f64 = 1e-8;

/// Ratios that differ by less count as equal.
const TIE: f64 = 1e-12;

/// Pivots per unknown after which the method gives up.
const PIVOTS_PER_UNKNOWN: usize = 20;

/// The problem of finding z ≥ 0 such that w = M z + q ≥ 0 and zᵀ w = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Lcp {
    /// M, (N, N), row after row.
    pub matrix: Vec<f64>,
    /// q, (N,).
    pub offset: Vec<f64>,
}

/// End of Lemke's method.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub enum LemkeEnd {
    /// A solution z, (N,).
    Solved(Vec<f64>),
    /// A secondary ray: no row limits the unknown that enters.
    Ray,
    /// Rounding errors: a residual above the tolerance, or too many pivots.
    Inexact,
}

impl LemkeEnd {
    /// z, if it was found.
    #[must_use]
    pub fn solution(&self) -> Option<&Vec<f64>> {
        match self {
            Self::Solved(z) => Some(z),
            Self::Ray | Self::Inexact => None,
        }
    }
}

impl Lcp {
    /// A problem of `order` unknowns, all zeros.
    #[must_use]
    pub fn zeros(order: usize) -> Self {
        Self {
            matrix: vec![0.0; order * order],
            offset: vec![0.0; order],
        }
    }

    /// Entry of M.
    pub fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.matrix[row * self.offset.len() + column]
    }

    /// Returns w for some z.
    #[must_use]
    pub fn complement(&self, z: &[f64]) -> Vec<f64> {
        let rows = self.matrix.chunks(z.len().max(1)).zip(&self.offset);
        rows.map(|(row, q)| q + row.iter().zip(z).map(|(m, z)| m * z).sum::<f64>())
            .collect()
    }

    /// Largest |min(z, w)|: zero exactly at a solution.
    #[must_use]
    pub fn residual(&self, z: &[f64]) -> f64 {
        let w = self.complement(z);
        let rows = w.iter().zip(z);
        rows.fold(0.0, |worst, (w, z)| worst.max(w.min(*z).abs()))
    }

    /// Follows Lemke's path from a covering vector of ones; a solution has at most this residual.
    pub fn lemke(&self, tolerance: f64) -> LemkeEnd {
        let order = self.offset.len();
        let by_offset = |a: &usize, b: &usize| self.offset[*a].total_cmp(&self.offset[*b]);
        let lowest = (0..order).rev().min_by(by_offset);
        let Some(mut row) = lowest.filter(|row| self.offset[*row] < 0.0) else {
            return LemkeEnd::Solved(vec![0.0; order]);
        };

        // the artificial unknown enters; the complement of what leaves enters next
        let mut tableau = Tableau::new(self);
        let artificial = 2 * order;
        let mut entering = artificial;
        for _ in 0..PIVOTS_PER_UNKNOWN * order {
            let left = tableau.pivot(row, entering);
            if left == artificial {
                let z = tableau.solution();
                return match self.residual(&z) <= tolerance {
                    true => LemkeEnd::Solved(z),
                    false => LemkeEnd::Inexact,
                };
            }
            entering = (left + order) % artificial;
            let Some(blocking) = tableau.blocking_row(entering) else {
                return LemkeEnd::Ray;
            };
            row = blocking;
        }
        LemkeEnd::Inexact
    }
}

/// Rows of w − M z − e z₀ = q, solved for the basic unknowns. Columns are w, z, z₀, q; those of w
/// are the inverse of the basis.
struct Tableau {
    rows: Vec<Vec<f64>>,
    /// Column of each row's basic unknown.
    basis: Vec<usize>,
}

impl Tableau {
    fn new(lcp: &Lcp) -> Self {
        let order = lcp.offset.len();
        let row = |i: usize| {
            let unit = (0..order).map(|j| f64::from(u8::from(i == j)));
            let matrix = lcp.matrix[i * order..][..order].iter().map(|m| -m);
            unit.chain(matrix).chain([-1.0, lcp.offset[i]]).collect()
        };
        Self {
            rows: (0..order).map(row).collect(),
            basis: (0..order).collect(),
        }
    }

    /// Makes `column` basic in `row`; returns the unknown that leaves.
    fn pivot(&mut self, row: usize, column: usize) -> usize {
        let mut pivot = std::mem::take(&mut self.rows[row]);
        let scale = 1.0 / pivot[column];
        pivot.iter_mut().for_each(|number| *number *= scale);
        for other in self.rows.iter_mut().filter(|other| !other.is_empty()) {
            let factor = other[column];
            if factor != 0.0 {
                for (to, from) in other.iter_mut().zip(&pivot) {
                    *to -= factor * from;
                }
                other[column] = 0.0;
            }
        }
        self.rows[row] = pivot;
        std::mem::replace(&mut self.basis[row], column)
    }

    /// Row whose basic unknown reaches zero first as `column` grows, ties broken by the inverse of
    /// the basis; the artificial unknown leaves as soon as it can.
    fn blocking_row(&self, column: usize) -> Option<usize> {
        let order = self.rows.len();
        let limits = |row: &usize| self.rows[*row][column] > LEAST_PIVOT;
        let mut tied: Vec<usize> = (0..order).filter(limits).collect();
        for key in std::iter::once(2 * order + 1).chain(0..order) {
            let ratio = |row: &usize| self.rows[*row][key] / self.rows[*row][column];
            let least = tied.iter().map(ratio).fold(f64::INFINITY, f64::min);
            tied.retain(|row| ratio(row) <= least + TIE);
            let artificial = tied.iter().find(|row| self.basis[**row] == 2 * order);
            if artificial.is_some() || tied.len() < 2 {
                return artificial.or(tied.first()).copied();
            }
        }
        tied.first().copied()
    }

    /// z of the basis.
    fn solution(&self) -> Vec<f64> {
        let order = self.rows.len();
        let mut z = vec![0.0; order];
        for (row, unknown) in self.rows.iter().zip(&self.basis) {
            if let Some(z) = unknown.checked_sub(order).and_then(|k| z.get_mut(k)) {
                *z = row[2 * order + 1].max(0.0);
            }
        }
        z
    }
}

#[cfg(test)]
mod tests {
    use stickslip_testkit::SplitMix64;

    use super::*;

    /// Solves the augmented rows (A, b) of A x = b by elimination, the largest pivot of each column
    /// first; `None` where A is singular.
    fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
        let n = rows.len();
        for k in 0..n {
            let best = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
            rows.swap(k, best);
            let pivot = rows[k].clone();
            if pivot[k].abs() < 1e-9 {
                return None;
            }
            for (i, row) in rows.iter_mut().enumerate() {
                let factor = if i == k { 0.0 } else { row[k] / pivot[k] };
                row.iter_mut()
                    .zip(&pivot)
                    .for_each(|(to, from)| *to -= factor * from);
            }
        }
        Some((0..n).map(|k| rows[k][n] / rows[k][k]).collect())
    }

    /// Every solution at a complementary basis: for each set of unknowns that may be positive, the
    /// one that makes their rows zero.
    fn enumerated(lcp: &Lcp) -> Vec<Vec<f64>> {
        let n = lcp.offset.len();
        let of_set = |set: usize| {
            let row = |i: usize| match set >> i & 1 {
                1 => [&lcp.matrix[i * n..][..n], &[-lcp.offset[i]]].concat(),
                _ => (0..=n).map(|j| f64::from(u8::from(i == j))).collect(),
            };
            solved((0..n).map(row).collect()).filter(|z| lcp.residual(z) < 1e-9)
        };
        (0..1 << n).filter_map(of_set).collect()
    }

    /// Random problems of four classes: positive definite, positive semidefinite, positive, any.
    fn random(rng: &mut SplitMix64, class: usize) -> Lcp {
        let n = 1 + rng.below(6);
        let rank = if class == 1 { n.div_ceil(2) } else { n };
        // whole numbers, so that no minor is nearly zero
        let factor: Vec<f64> = (0..n * rank).map(|_| rng.below(5) as f64 - 2.0).collect();
        let mut lcp = Lcp::zeros(n);
        for i in 0..n {
            for j in 0..n {
                let gram = (0..rank).map(|k| factor[i * rank + k] * factor[j * rank + k]);
                *lcp.entry(i, j) = match class {
                    0 => gram.sum::<f64>() + if i == j { 0.1 } else { 0.0 },
                    1 => gram.sum(),
                    2 => rng.within(0.1, 1.0),
                    _ => rng.within(-1.0, 1.0),
                };
            }
            // degenerate now and then
            lcp.offset[i] = if rng.one_in(4) {
                0.0
            } else {
                rng.within(-1.0, 1.0)
            };
        }
        lcp
    }

    /// A problem of class 0 or 2 always has a solution; a ray proves that one of class 1 has none.
    #[test]
    fn lemke_finds_one_of_the_solutions_that_enumeration_finds() {
        let mut rng = SplitMix64::new(1);
        let (mut found, mut rays) = ([0; 4], [0; 4]);
        for k in 0..4000 {
            let class = k % 4;
            let lcp = random(&mut rng, class);
            let all = enumerated(&lcp);
            match lcp.lemke(1e-9) {
                LemkeEnd::Solved(z) => {
                    let near =
                        |other: &Vec<f64>| z.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-6);
                    assert!(all.iter().any(near), "{lcp:?}: {z:?} is none of {all:?}");
                    assert!(class != 0 || all.iter().all(near), "{lcp:?}: {all:?}");
                    found[class] += 1;
                }
                LemkeEnd::Ray => {
                    assert!(
                        class == 3 || all.is_empty(),
                        "class {class}, {lcp:?}: {all:?}"
                    );
                    rays[class] += 1;
                }
                LemkeEnd::Inexact => panic!("class {class}, {lcp:?}"),
            }
        }
        assert_eq!((found[0], found[2]), (1000, 1000));
        assert!(found[1] > 300 && found[3] > 300, "{found:?}");
        assert!(rays[1] > 50 && rays[3] > 50, "{rays:?}");
    }
}
