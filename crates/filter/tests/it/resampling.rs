//! Resampling schemes: counts average to N w, weight zero is never drawn, noise is bounded as the
//! schemes promise.

use stickslip_filter::{Resampling, Streams};

const SCHEMES: [Resampling; 4] = [
    Resampling::Systematic,
    Resampling::Stratified,
    Resampling::Residual,
    Resampling::Multinomial,
];

fn counts(scheme: Resampling, weights: &[f64], ancestors: usize, step: u64) -> Vec<f64> {
    let mut drawn = vec![u32::MAX; ancestors];
    scheme.ancestors(weights, Streams::new(11).at(step), &mut drawn);
    let mut counts = vec![0.0; weights.len()];
    for ancestor in drawn {
        counts[ancestor as usize] += 1.0;
    }
    counts
}

fn uneven_weights(n: usize) -> Vec<f64> {
    let raw: Vec<f64> = (0..n)
        .map(|i| {
            if i % 7 == 0 {
                0.0
            } else {
                ((i * 31) % 17) as f64 + 0.25
            }
        })
        .collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}

#[test]
fn counts_average_to_n_times_weight() {
    const DRAWS: u64 = 4000;
    let weights = uneven_weights(50);
    for scheme in SCHEMES {
        for ancestors in [50, 20] {
            let mut mean = vec![0.0; weights.len()];
            for step in 0..DRAWS {
                let counts = counts(scheme, &weights, ancestors, step);
                mean.iter_mut()
                    .zip(counts)
                    .for_each(|(m, c)| *m += c / DRAWS as f64);
            }
            for (w, mean) in weights.iter().zip(mean) {
                // no scheme is noisier than the multinomial: variance N w (1 - w)
                let expected = ancestors as f64 * w;
                let error = (expected * (1.0 - w) / DRAWS as f64).sqrt();
                assert!(
                    (mean - expected).abs() <= 4.5 * error,
                    "{scheme:?}: {mean}, expected {expected} +- {error}"
                );
            }
        }
    }
}

#[test]
fn systematic_counts_are_the_integers_next_to_n_w() {
    let weights = uneven_weights(200);
    for step in 0..200 {
        for (w, count) in weights
            .iter()
            .zip(counts(Resampling::Systematic, &weights, 200, step))
        {
            assert!(
                (count - 200.0 * w).abs() < 1.0 + 1e-9,
                "{count} for {}",
                200.0 * w
            );
        }
    }
}

#[test]
fn stratified_counts_are_within_two_and_residual_at_least_the_floor() {
    let weights = uneven_weights(200);
    for step in 0..200 {
        for (w, count) in weights
            .iter()
            .zip(counts(Resampling::Stratified, &weights, 200, step))
        {
            assert!((count - 200.0 * w).abs() < 2.0);
        }
        for (w, count) in weights
            .iter()
            .zip(counts(Resampling::Residual, &weights, 200, step))
        {
            assert!(count >= (200.0 * w).floor());
        }
    }
}

#[test]
fn systematic_with_equal_weights_keeps_every_particle() {
    for n in [1, 3, 49, 1000] {
        let kept = counts(Resampling::Systematic, &vec![1.0 / n as f64; n], n, 1);
        assert!(
            kept.iter().filter(|&&c| c != 1.0).count() <= 2,
            "rounding may move a point over an edge"
        );
    }
}

#[test]
fn one_particle_with_all_the_mass_is_every_ancestor() {
    for scheme in SCHEMES {
        for heavy in [0, 3, 9] {
            let mut weights = [0.0; 10];
            weights[heavy] = 1.0;
            for step in 0..100 {
                assert_eq!(
                    counts(scheme, &weights, 10, step)[heavy],
                    10.0,
                    "{scheme:?}"
                );
            }
        }
    }
}

#[test]
#[should_panic(expected = "have no ancestors")]
fn weights_that_are_all_zero_panic() {
    let _ = counts(Resampling::Systematic, &[0.0; 4], 4, 0);
}
