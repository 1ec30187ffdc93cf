//! Accuracy of the errors that an estimate reports of itself: [`Belief`].

use stickslip::dynamics::Pose;

/// Standard deviations on either side of the centre that contain 90 % of a normal distribution.
pub(crate) const NINETY_PERCENT: f64 = 1.644_853_626_951_472_7;

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
        for Judged { error, std } in rows {
            let pairs = [
                (error.x, std.x, 1.0),
                (error.y, std.y, 1.0),
                (error.theta, std.theta, virtual_radius),
            ];
            for (error, std, length) in pairs {
                held += f64::from(u8::from(error.abs() <= NINETY_PERCENT * std));
                crps += 1e3 * length * normal_crps(error, std);
                count += 1.0;
            }
        }
        Self {
            covered: (count > 0.0).then(|| held / count),
            crps_mm: (count > 0.0).then(|| crps / count),
        }
    }
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
