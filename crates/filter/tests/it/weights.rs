//! Log-weights: effective sample size, Bayes' rule, extremes.
use stickslip_filter::{LogWeights, WeightError};

fn ess(log: &[f64]) -> f64 {
    LogWeights::new(log.to_vec())
        .unwrap()
        .effective_sample_size()
}

#[test]
fn effective_sample_size_of_known_weights() {
    assert_eq!(ess(&[0.0; 100]), 100.0);
    // weights 1, 2, 3: 36 / 14
    let log: Vec<f64> = [1.0f64, 2.0, 3.0].iter().map(|w| libm::log(*w)).collect();
    assert!((ess(&log) - 36.0 / 14.0).abs() < 1e-14);
    assert_eq!(ess(&[0.0, f64::NEG_INFINITY, 0.0]), 2.0);
}

#[test]
fn effective_sample_size_is_unchanged_by_a_constant_factor() {
    let log: Vec<f64> = (0..1000).map(|i| f64::from(i % 37) * 0.2).collect();
    for constant in [-1e6, -700.0, 800.0, 1e6] {
        let moved: Vec<f64> = log.iter().map(|l| l + constant).collect();
        assert!((ess(&moved) / ess(&log) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn multiply_gives_the_posterior_and_the_evidence() {
    let mut weights = LogWeights::new([0.2f64, 0.8].map(libm::log).to_vec()).unwrap();
    let evidence = weights.multiply(&[0.5f64, 0.25].map(libm::log)).unwrap();
    assert!((evidence - libm::log(0.3)).abs() < 1e-15);
    assert!((weights.weights()[0] - 1.0 / 3.0).abs() < 1e-15);
    assert!((libm::exp(weights.log_weights()[1]) - 2.0 / 3.0).abs() < 1e-15);
}

#[test]
fn multiply_by_tiny_likelihoods_does_not_underflow() {
    let mut weights = LogWeights::equal(2);
    for _ in 0..1000 {
        assert!(weights.multiply(&[-1e4, -1e4 + 1e-3]).is_some());
    }
    let ratio = weights.weights()[1] / weights.weights()[0];
    assert!((ratio / std::f64::consts::E - 1.0).abs() < 1e-8, "{ratio}");
    assert!((weights.weights().iter().sum::<f64>() - 1.0).abs() < 1e-15);
}

#[test]
fn multiply_by_zero_likelihood_is_none_and_changes_nothing() {
    let mut weights = LogWeights::new(vec![0.0, -1.0, f64::NEG_INFINITY]).unwrap();
    let before = weights.clone();
    assert_eq!(
        weights.multiply(&[f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0]),
        None
    );
    assert_eq!(weights, before);
    assert_eq!(weights.best_log_likelihood(&[1.0, 2.0, 3.0]), 2.0);
}

#[test]
fn new_refuses_what_is_no_set_of_weights() {
    assert_eq!(LogWeights::new(vec![]), Err(WeightError::Empty));
    assert_eq!(
        LogWeights::new(vec![0.0, f64::NAN]),
        Err(WeightError::NotANumber { particle: 1 })
    );
    assert_eq!(
        LogWeights::new(vec![f64::INFINITY]),
        Err(WeightError::NotANumber { particle: 0 })
    );
    assert_eq!(
        LogWeights::new(vec![f64::NEG_INFINITY; 3]),
        Err(WeightError::AllZero)
    );
}
