//! Accuracy of the errors that an estimate reports of itself: [`Belief`].

use stickslip::dynamics::Pose;

/// Standard deviations on either side of the centre that contain 90 % of a normal distribution.
pub(crate) const NINETY_PERCENT: f64 = 1.644_853_626_951_472_7;

/// Number of equal parts of 0..1 in which [`Belief::pit`] counts.
pub const PIT_BINS: usize = 10;

/// Agreement of an estimate's poses and standard deviations with a reference over some rows; `None`
/// over no rows, and for methods without a spread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Belief {
    /// Share of the 90 % intervals of x, y and θ, estimate ± 1.645 standard deviations, that cover
    /// the reference; 0.9 where the belief is calibrated.
    pub covered: Option<f64>,
    /// Continuous ranked probability score of normal distributions with these centres and standard
    /// deviations, the mean over x, y and r_v θ (mm); the lower the better, an absolute error where
    /// the spread is 0 (Gneiting & Raftery 2007, paragraph 4.2).
    pub crps_mm: Option<f64>,
    /// Histogram of the probability integral transform (Gneiting, Balabdaoui & Raftery 2007,
    /// section 3.1). Share of the reference's x, y and θ in each tenth of these normal
    /// distributions, from the lowest to the highest. A calibrated belief has 0.1 in each, one that
    /// is too narrow more in the outer tenths.
    pub pit: Option<[f64; PIT_BINS]>,
}

/// Estimate minus reference at one row, with the estimate's own standard deviations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judged {
    /// Errors (m, m, rad), θ on the circle.
    pub error: Pose,
    /// Standard deviations (m, m, rad).
    pub std: Pose,
}

impl Belief {
    /// Over some rows; `virtual_radius` is r_v (m).
    pub(crate) fn of(rows: impl Iterator<Item = Judged>, virtual_radius: f64) -> Self {
        let (mut held, mut crps, mut count) = (0.0, 0.0, 0.0);
        let mut pit = [0.0; PIT_BINS];
        for Judged { error, std } in rows {
            let pairs = [
                (error.x, std.x, 1.0),
                (error.y, std.y, 1.0),
                (error.theta, std.theta, virtual_radius),
            ];
            for (error, std, length) in pairs {
                held += f64::from(u8::from(error.abs() <= NINETY_PERCENT * std));
                crps += 1e3 * length * normal_crps(error, std);
                pit[tenth(error, std)] += 1.0;
                count += 1.0;
            }
        }
        Self {
            covered: (count > 0.0).then(|| held / count),
            crps_mm: (count > 0.0).then(|| crps / count),
            pit: (count > 0.0).then(|| pit.map(|held| held / count)),
        }
    }
}

/// Part of a normal distribution in which the reference lies, if its mean is off by `error`.
fn tenth(error: f64, std: f64) -> usize {
    let z = if error == 0.0 { 0.0 } else { -error / std };
    let below = 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
    ((PIT_BINS as f64 * below) as usize).min(PIT_BINS - 1)
}

/// CRPS of a normal distribution whose mean is off by `error`, in its unit.
fn normal_crps(error: f64, std: f64) -> f64 {
    if std <= 0.0 {
        return error.abs();
    }
    let z = error / std;
    let density = libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
    let within = libm::erf(z / std::f64::consts::SQRT_2);
    std * (z * within + 2.0 * density - 1.0 / std::f64::consts::PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_filter::Streams;

    fn judged(error: f64, std: f64) -> Judged {
        Judged {
            error: Pose::new(error, error, error),
            std: Pose::new(std, std, std),
        }
    }

    /// E|X − y| − E|X − X'| / 2 over draws of X, the definition.
    #[test]
    fn the_score_is_its_definition_over_draws() {
        for (error, std) in [(0.0, 1.0), (0.7, 1.0), (-3.0, 0.5), (2.0, 0.0)] {
            let draws: Vec<f64> = (0..400)
                .map(|i| error + std * Streams::new(3).normals::<2>(i, 0, 0)[0])
                .collect();
            let n = draws.len() as f64;
            let from_truth: f64 = draws.iter().map(|x| x.abs()).sum::<f64>() / n;
            let pairs = draws
                .iter()
                .flat_map(|a| draws.iter().map(move |b| (a - b).abs()));
            let apart = pairs.sum::<f64>() / (n * n);
            let expected = from_truth - 0.5 * apart;
            let found = normal_crps(error, std);
            assert!(
                (found - expected).abs() < 0.08 * std + 1e-12,
                "{error} {std}: {found}, {expected}"
            );
        }
    }

    /// Beliefs that are right, half as wide, twice as wide, and all too high.
    #[test]
    fn the_transform_is_even_where_the_belief_is_right() {
        let pit = |std: f64, shift: f64| {
            let draw = |i: u64| Streams::new(11).normals::<2>(i, 0, 0)[0];
            let rows = (0..4000).map(|i| judged(draw(i) + shift, std));
            Belief::of(rows, 1.0).pit.expect("rows")
        };
        let even = pit(1.0, 0.0);
        assert!((even.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(
            even.iter().all(|share| (share - 0.1).abs() < 0.02),
            "{even:?}"
        );
        let (narrow, wide, high) = (pit(0.5, 0.0), pit(2.0, 0.0), pit(1.0, 1.0));
        assert!(narrow[0] > 0.2 && narrow[9] > 0.2, "{narrow:?}");
        assert!(wide[0] < 0.02 && wide[9] < 0.02, "{wide:?}");
        assert!(high[0] > 0.3 && high[9] < 0.02, "{high:?}");
    }

    #[test]
    fn a_belief_without_a_spread_has_its_reference_on_a_side_or_in_the_middle() {
        let of = |error| Belief::of([judged(error, 0.0)].into_iter(), 1.0).pit;
        let whole = |k: usize| Some(std::array::from_fn(|tenth| f64::from(u8::from(tenth == k))));
        assert_eq!([of(1.0), of(0.0), of(-1.0)], [whole(0), whole(5), whole(9)]);
    }

    #[test]
    fn intervals_hold_what_they_say_and_angles_count_by_the_radius() {
        let normal = |i: u64| Streams::new(7).normals::<2>(i, 0, 0)[0];
        let belief = Belief::of((0..4000).map(|i| judged(normal(i), 1.0)), 0.5);
        let covered = belief.covered.expect("rows");
        assert!((covered - 0.9).abs() < 0.02, "{covered}");
        let (whole, half) = (
            Belief::of([judged(1.0, 0.0)].into_iter(), 1.0),
            Belief::of([judged(1.0, 0.0)].into_iter(), 0.5),
        );
        assert_eq!(whole.crps_mm, Some(1e3));
        assert_eq!(half.crps_mm, Some(2.5e3 / 3.0));
        assert_eq!(half.covered, Some(0.0));
        assert_eq!(Belief::of(std::iter::empty(), 1.0), Belief::default());
    }
}
