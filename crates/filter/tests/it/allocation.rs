//! After the first steps, a step on one thread allocates nothing.

use crate::common::{Axis, POSITION, settings};
use stickslip_filter::{ParticleFilter, Resampling, Settings};

#[test]
fn step_and_estimates_after_warm_up_allocate_nothing() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    for resampling in [
        Resampling::Systematic,
        Resampling::Stratified,
        Resampling::Residual,
        Resampling::Multinomial,
    ] {
        // resample at every step that is not equally weighted
        let settings = Settings {
            resampling,
            resample_below: 1.0,
            ..settings(3000, 1)
        };
        let mut filter = ParticleFilter::new(Axis::GATED, settings).unwrap();
        pool.install(|| {
            let _ = filter.step(&0.1, Some(&0.1));
            let (mut resampled, mut collapsed) = (0, 0);
            let info = allocation_counter::measure(|| {
                for observation in [
                    Some(0.2),
                    None,
                    Some(0.3),
                    Some(40.0),
                    Some(40.1),
                    Some(40.2),
                ] {
                    let report = filter.step(&0.1, observation.as_ref());
                    resampled += usize::from(report.resampled);
                    collapsed += usize::from(report.collapsed());
                    let mean = filter.expectation(POSITION, |x| x);
                    let _ = filter.weighted_circular_std_about(mean, POSITION);
                }
            });
            assert!(resampled >= 3 && collapsed == 1, "{resampled} {collapsed}");
            assert_eq!(info.count_total, 0, "{info:?}");
        });
    }
}
