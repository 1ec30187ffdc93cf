//! Scores over many seeds: quantiles, [`Band`] and [`PairedDifference`].

/// The `q`-quantile of some numbers, `q` in [0, 1], linear between order statistics: position q (n - 1) from the smallest; `None` of
/// nothing.
///
/// ```
/// # use stickslip::quantile;
/// assert_eq!(quantile(&[4.0, 1.0, 2.0, 3.0], 0.5), Some(2.5));
/// assert_eq!(quantile(&[], 0.5), None);
/// ```
#[must_use]
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let position = q * last as f64;
    let lower = position.floor() as usize;
    let upper = (lower + 1).min(last);
    Some(values[lower] + (position - lower as f64) * (values[upper] - values[lower]))
}

/// Where most of some numbers lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Their 10 % quantile.
    pub low: f64,
    /// Their median.
    pub median: f64,
    /// Their 90 % quantile.
    pub high: f64,
}

impl Band {
    /// The band of some numbers; `None` of nothing.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let at = |q: f64| quantile(values, q);
        Some(Self { low: at(0.1)?, median: at(0.5)?, high: at(0.9)? })
    }
}

/// By how much one method's scores are above another's, seed by seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedDifference {
    /// Mean of a - b over the pairs, in the scores' unit.
    pub mean: f64,
    /// Standard error of that mean, s/√n with s the pairs' sample standard deviation; infinite for a single pair.
    pub standard_error: f64,
    /// Number of pairs.
    pub pairs: usize,
}

/// What a difference says, once its error is taken into account.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The first is below the second.
    Below,
    /// The difference is within its error.
    Unclear,
    /// The first is above the second.
    Above,
}

impl PairedDifference {
    /// The difference a - b of scores of the same seeds; `None` of no pairs.
    ///
    /// # Panics
    /// If there are not as many of the one as of the other.
    #[must_use]
    pub fn of(a: &[f64], b: &[f64]) -> Option<Self> {
        assert_eq!(a.len(), b.len(), "scores come in pairs");
        let pairs = a.len();
        let differences = || a.iter().zip(b).map(|(a, b)| a - b);
        let mean = differences().fold(0.0, |sum, d| sum + d) / pairs as f64;
        let squares = differences().fold(0.0, |sum, d| sum + (d - mean) * (d - mean));
        let standard_error = if pairs > 1 { (squares / (pairs - 1) as f64 / pairs as f64).sqrt() } else { f64::INFINITY };
        (pairs > 0).then_some(Self { mean, standard_error, pairs })
    }

    /// The direction of the difference, where it exceeds `errors` of its standard errors.
    #[must_use]
    pub fn direction(&self, errors: f64) -> Direction {
        let least = errors * self.standard_error;
        match self.mean {
            mean if mean < -least => Direction::Below,
            mean if mean > least => Direction::Above,
            _ => Direction::Unclear,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn band_of_the_numbers_0_to_10() {
        let numbers: Vec<f64> = (0..=10).rev().map(f64::from).collect();
        assert_eq!(Band::of(&numbers), Some(Band { low: 1.0, median: 5.0, high: 9.0 }));
        assert_eq!(Band::of(&[7.0]), Some(Band { low: 7.0, median: 7.0, high: 7.0 }));
        assert_eq!(Band::of(&[]), None);
    }

    /// The differences 1 to n have the mean (n + 1)/2 and the variance n (n + 1)/12, so that its standard error is √((n + 1)/12).
    #[test]
    fn paired_difference_of_1_to_n_matches_its_closed_form() {
        for n in [2, 5, 20, 101] {
            let b: Vec<f64> = (0..n).map(|k| f64::from(k * k)).collect();
            let a: Vec<f64> = (0..n).map(|k| f64::from(k * k) + f64::from(k + 1)).collect();
            let difference = PairedDifference::of(&a, &b).unwrap();
            assert!((difference.mean - f64::from(n + 1) / 2.0).abs() < 1e-12);
            assert!((difference.standard_error - (f64::from(n + 1) / 12.0).sqrt()).abs() < 1e-12, "{difference:?}");
            assert_eq!(difference.direction(2.0), if n > 2 { Direction::Above } else { Direction::Unclear });
            assert_eq!(PairedDifference::of(&b, &a).unwrap().direction(2.0), if n > 2 { Direction::Below } else { Direction::Unclear });
        }
    }

    #[test]
    fn equal_differences_have_no_error_and_a_single_one_says_nothing() {
        let difference = PairedDifference::of(&[1.0, 2.0], &[1.5, 2.5]).unwrap();
        assert_eq!((difference.mean, difference.standard_error, difference.pairs), (-0.5, 0.0, 2));
        assert_eq!(difference.direction(2.0), Direction::Below);
        assert_eq!(PairedDifference::of(&[1.0], &[9.0]).unwrap().direction(2.0), Direction::Unclear);
        assert_eq!(PairedDifference::of(&[1.0, 1.0], &[1.0, 1.0]).unwrap().direction(2.0), Direction::Unclear);
        assert_eq!(PairedDifference::of(&[], &[]), None);
    }
}
