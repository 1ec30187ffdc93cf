//! Likelihood of a model that is only nearly right: [`power`].
//!
//! No friction and no three feet are right for all pushes of a real object, and more pushes do not
//! average that out. A posterior that counts every push as a witness of its own becomes too narrow,
//! and predicts worse than one that does not. The likelihood is therefore raised to a power, so
//! that any number of pushes says as much as a few (the coarsened posterior of Miller & Dunson,
//! Robust Bayesian inference via coarsening, JASA 2019). Where the model is right, its predictions
//! hardly drift, and every push counts.

/// Number of pushes that all pushes are worth at most where the model is not right.
const COARSE: f64 = 6.0;

/// Drift at which half of that counts (m/m).
const HALF_DRIFT: f64 = 0.01;

/// Power of the likelihood of so many pushes, whose predictions drift by `drift` (m/m).
pub(crate) fn power(pushes: usize, drift: f64) -> f64 {
    let ratio = HALF_DRIFT / drift;
    let wrong = 1.0 / (1.0 + ratio * ratio * ratio);
    COARSE / (COARSE + wrong * pushes as f64)
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn pushes_of_a_right_model_count_one_by_one_and_others_as_six() {
        let worth = |pushes, drift| pushes as f64 * power(pushes, drift);
        assert!((worth(100, 0.0) - 100.0).abs() < 1e-12);
        assert!((worth(100_000, 1.0) - 6.0).abs() < 1e-2);
        assert!((worth(2, 1.0) - 1.5).abs() < 1e-2);
        let worths = [0.002, 0.005, 0.01, 0.02].map(|drift| worth(20, drift));
        assert!(worths.is_sorted_by(|a, b| a > b), "{worths:?}");
    }
}
