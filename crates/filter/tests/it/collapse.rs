//! A particle set that does not explain its observation.

use crate::common::{Axis, POSITION, VELOCITY, mean, settings, std};
use stickslip_filter::{Block, BlockMut, Draw, Model, ParticleFilter, WeightUpdate};

#[test]
fn step_with_an_impossible_observation_collapses_and_reinitialises_around_it() {
    let mut filter = ParticleFilter::new(Axis::GATED, settings(1000, 3)).unwrap();
    let report = filter.step(&0.1, Some(&50.0));
    assert_eq!(
        report.weight_update,
        WeightUpdate::Collapsed {
            best_log_likelihood: f64::NEG_INFINITY
        }
    );
    assert!(report.collapsed());
    assert_eq!(report.effective_sample_size, 1000.0);

    // 1000 draws of standard deviation 0.3 about 50: the mean's standard error is 0.0095
    assert!((mean(&filter, POSITION) - 50.0).abs() < 0.04);
    assert!((std(&filter, POSITION) - 0.3).abs() < 0.03);
    assert!(filter.particles().column(VELOCITY).all(f64::is_finite));

    let next = filter.step(&0.1, Some(&50.0));
    assert!(!next.collapsed(), "{next:?}");
}

#[test]
fn collapse_resamples_by_the_weights_before_the_observation() {
    let settings = stickslip_filter::Settings {
        resample_below: 0.0,
        ..settings(1000, 3)
    };
    let mut filter = ParticleFilter::new(Axis::GATED, settings).unwrap();
    let _ = filter.step(&0.5, Some(&0.5));
    let before = mean(&filter, VELOCITY);
    let unweighted = filter.particles().column(VELOCITY).sum::<f64>() / 1000.0;
    let report = filter.step(&1e-9, Some(&50.0));
    assert!(report.collapsed() && !report.resampled);
    let after = mean(&filter, VELOCITY);
    // this model does not reinitialise velocities; systematic resampling keeps their weighted mean
    // to about 1/sqrt(N)
    assert!((after - before).abs() < 0.02, "{after} not {before}");
    assert!(
        (after - unweighted).abs() > 0.1,
        "{after} is {unweighted}: the weights took no part"
    );
}

/// A model of one column whose likelihood is the observation itself.
struct Given {
    collapse_below: f64,
}

impl Model for Given {
    type Input = ();
    type Observation = f64;
    type Scratch = ();
    type Sums = ();

    fn columns(&self) -> usize {
        1
    }
    fn scratch(&self) {}
    fn initialise(&self, _: Draw, _: &mut BlockMut<'_>) {}
    fn propagate(&self, (): &(), _: Draw, _: &mut BlockMut<'_>, (): &mut ()) {}
    fn log_likelihood(&self, observation: &f64, _: &Block<'_>, out: &mut [f64]) {
        out.fill(*observation);
    }
    fn sum(&self, (): &(), _: &Block<'_>, _: &[f64], (): &mut ()) {}
    fn collapsed(&self, best: f64) -> bool {
        best < self.collapse_below
    }
    fn reinitialise(&self, observation: &f64, _: Draw, block: &mut BlockMut<'_>) {
        block.column_mut(0).fill(*observation);
    }
}

#[test]
fn collapsed_is_the_models_choice_but_zero_likelihood_always_collapses() {
    let never = Given {
        collapse_below: f64::NEG_INFINITY,
    };
    let mut filter = ParticleFilter::new(never, settings(70, 0)).unwrap();
    assert_eq!(
        filter.step(&(), Some(&-1e300)).weight_update,
        WeightUpdate::Weighed {
            log_evidence: -1e300
        }
    );
    assert!(filter.step(&(), Some(&f64::NEG_INFINITY)).collapsed());

    let mut filter = ParticleFilter::new(
        Given {
            collapse_below: -50.0,
        },
        settings(70, 0),
    )
    .unwrap();
    assert!(!filter.step(&(), Some(&-49.0)).collapsed());
    assert_eq!(
        filter.step(&(), Some(&-51.0)).weight_update,
        WeightUpdate::Collapsed {
            best_log_likelihood: -51.0
        }
    );
    assert_eq!(filter.particles().value(69, 0), -51.0);
    assert_eq!(
        filter.step(&(), None).weight_update,
        WeightUpdate::Unobserved
    );
}

#[test]
#[should_panic(expected = "NaN")]
fn step_with_a_likelihood_that_is_nan_panics() {
    let mut filter = ParticleFilter::new(
        Given {
            collapse_below: -50.0,
        },
        settings(70, 0),
    )
    .unwrap();
    let _ = filter.step(&(), Some(&f64::NAN));
}
