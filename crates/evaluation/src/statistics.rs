//! Scores over many seeds: [`Band`] and [`PairedDifference`].

use serde::Serialize;
use stickslip::quantile;

/// Median of some numbers, and the band that holds 80 % of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Their median.
    pub median: f64,
    /// Their 10 % quantile.
    pub low: f64,
    /// Their 90 % quantile.
    pub high: f64,
}

impl Band {
    /// The band of some numbers; `None` of nothing.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let at = |q: f64| quantile(values, q);
        Some(Self {
            low: at(0.1)?,
            median: at(0.5)?,
            high: at(0.9)?,
        })
    }
}

/// Standard deviations of a normal distribution that 95 % lie within.
const NORMAL_95: f64 = 1.96;

/// Pairs below which a median has no standard error.
pub const FEWEST_PAIRS: usize = 6;

/// Difference of one method's scores from another's, seed by seed.
///
/// Scores of methods that lose the object now and then have heavy tails, so that the median of the
/// differences is reported, not their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedDifference {
    /// Median of a - b over the pairs, in the scores' unit.
    pub median: f64,
    /// Distribution-free 95 % interval of that median, from one order statistic to another. Also of
    /// heavy-tailed differences, of which the median is far from the middle of it. `None` for fewer
    /// than six pairs, which have no such interval.
    pub interval: Option<[f64; 2]>,
    /// Standard error of that median: the length of its interval over 2 · 1.96 (McKean & Schrader
    /// 1984). Infinite where there is none.
    pub standard_error: f64,
    /// Number of pairs.
    pub pairs: usize,
}

/// Direction of a difference, once its error is taken into account.
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
        let mut differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        differences.sort_by(f64::total_cmp);
        let interval = interval_of_median(&differences);
        let length = interval.map_or(f64::INFINITY, |[low, high]| high - low);
        Some(Self {
            median: quantile(&differences, 0.5)?,
            interval,
            standard_error: length / (2.0 * NORMAL_95),
            pairs: a.len(),
        })
    }

    /// The direction of the difference, where it exceeds `errors` of its standard errors.
    #[must_use]
    pub fn direction(&self, errors: f64) -> Direction {
        let least = errors * self.standard_error;
        match self.median {
            median if median < -least => Direction::Below,
            median if median > least => Direction::Above,
            _ => Direction::Unclear,
        }
    }
}

/// Distribution-free 95 % interval of the median of sorted numbers.
fn interval_of_median(sorted: &[f64]) -> Option<[f64; 2]> {
    let n = sorted.len();
    if n < FEWEST_PAIRS {
        return None;
    }
    // the interval from the c-th smallest to the c-th largest
    let c = ((n + 1) as f64 / 2.0 - NORMAL_95 * (n as f64 / 4.0).sqrt())
        .round()
        .max(1.0) as usize;
    Some([sorted[c - 1], sorted[n - c]])
}

/// Returns the p-value of the sign test, two-sided: how likely so many wins and losses or fewer of
/// the rarer are, if both are equally likely. 1 of no pairs.
#[must_use]
pub fn sign_test(wins: u32, losses: u32) -> f64 {
    let n = wins + losses;
    // binomial coefficients over 2ⁿ, each from the one before
    let mut term = 0.5_f64.powi(n as i32);
    let mut sum = 0.0;
    for k in 0..=wins.min(losses) {
        sum += term;
        term *= f64::from(n - k) / f64::from(k + 1);
    }
    (2.0 * sum).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn band_of_the_numbers_0_to_10() {
        let numbers: Vec<f64> = (0..=10).rev().map(f64::from).collect();
        assert_eq!(
            Band::of(&numbers),
            Some(Band {
                low: 1.0,
                median: 5.0,
                high: 9.0
            })
        );
        assert_eq!(
            Band::of(&[7.0]),
            Some(Band {
                low: 7.0,
                median: 7.0,
                high: 7.0
            })
        );
        assert_eq!(Band::of(&[]), None);
    }

    /// Twenty of twenty pairs are below 0, most a little and some by far: the interval excludes 0,
    /// two standard errors about the median do not.
    #[test]
    fn the_interval_of_a_skewed_difference_lies_on_its_side() {
        let a: Vec<f64> = (0..20).map(|k| -libm::pow(1.3, f64::from(k))).collect();
        let found = PairedDifference::of(&a, &[0.0; 20]).unwrap();
        // from the 6th smallest to the 6th largest
        assert_eq!(found.interval, Some([a[14], a[5]]));
        assert_eq!(found.direction(2.0), Direction::Unclear);
        assert_eq!(
            PairedDifference::of(&a[..5], &[0.0; 5]).unwrap().interval,
            None
        );
    }

    /// Evenly spread over (0, 1), n numbers have a median whose standard error tends to 1/(2 f √n)
    /// with the density f = 1.
    #[test]
    fn error_of_the_median_tends_to_its_closed_form() {
        for n in [400_u32, 10_000, 160_000] {
            let b: Vec<f64> = (0..n).map(|k| f64::from(k % 17)).collect();
            let a: Vec<f64> = (0..n)
                .map(|k| f64::from(k % 17) + (f64::from(k) + 0.5) / f64::from(n))
                .collect();
            let difference = PairedDifference::of(&a, &b).unwrap();
            assert!((difference.median - 0.5).abs() < 1e-9);
            assert!(
                (difference.standard_error * 2.0 * f64::from(n).sqrt() - 1.0).abs() < 0.05,
                "{difference:?}"
            );
            assert_eq!(difference.direction(2.0), Direction::Above);
            assert_eq!(
                PairedDifference::of(&b, &a).unwrap().direction(2.0),
                Direction::Below
            );
        }
    }

    /// Of 20 pairs the interval goes from the 6th to the 15th; one lost object does not change it.
    #[test]
    fn difference_of_twenty_pairs_is_that_of_order_statistics() {
        let b = [0.0; 20];
        let mut a: Vec<f64> = (1..=20).map(f64::from).collect();
        let difference = PairedDifference::of(&a, &b).unwrap();
        assert_eq!(
            (difference.median, difference.standard_error),
            (10.5, 9.0 / 3.92)
        );
        a[19] = 1e6;
        assert_eq!(PairedDifference::of(&a, &b), Some(difference));
    }

    #[test]
    fn sign_test_of_twenty_against_six() {
        // the tail of the binomial distribution of 26 with 1/2, by its table
        assert!(
            (sign_test(20, 6) - 0.009_355).abs() < 1e-6,
            "{}",
            sign_test(20, 6)
        );
        assert_eq!(sign_test(6, 20), sign_test(20, 6));
        assert_eq!([sign_test(0, 0), sign_test(3, 3)], [1.0, 1.0]);
        assert_eq!(sign_test(5, 0), 0.0625);
    }

    #[test]
    fn equal_differences_have_no_error_and_few_say_nothing() {
        let difference = PairedDifference::of(&[1.0; 6], &[1.5; 6]).unwrap();
        assert_eq!(
            difference,
            PairedDifference {
                median: -0.5,
                interval: Some([-0.5; 2]),
                standard_error: 0.0,
                pairs: 6
            }
        );
        assert_eq!(difference.direction(2.0), Direction::Below);
        assert_eq!(
            PairedDifference::of(&[1.0; 5], &[9.0; 5])
                .unwrap()
                .direction(2.0),
            Direction::Unclear
        );
        assert_eq!(
            PairedDifference::of(&[1.0; 7], &[1.0; 7])
                .unwrap()
                .direction(2.0),
            Direction::Unclear
        );
        assert_eq!(PairedDifference::of(&[], &[]), None);
    }
}
