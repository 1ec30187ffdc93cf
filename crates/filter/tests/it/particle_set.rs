//! Particle sets: blocks, columns, gathering.

use crate::common;
use stickslip_filter::{BLOCK, ParticleFilter, ParticleSet, Settings, SettingsError};

/// Particle i's column c is 1000 c + i.
fn numbered(particles: usize, columns: usize) -> ParticleSet {
    let mut set = ParticleSet::zeros(particles, columns);
    set.for_each_block(|block| {
        let first = block.first_particle() as usize;
        for (c, column) in block.all_columns_mut().enumerate() {
            for (lane, x) in column.iter_mut().enumerate() {
                *x = (1000 * c + first + lane) as f64;
            }
        }
    });
    set
}

#[test]
fn blocks_cover_every_particle_once_and_hide_the_padding() {
    for particles in [1, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 5] {
        let set = numbered(particles, 2);
        let covered: Vec<usize> = set.blocks().flat_map(|block| block.range()).collect();
        assert_eq!(covered, (0..particles).collect::<Vec<_>>());
        let column: Vec<f64> = set.column(1).collect();
        assert_eq!(
            column,
            (0..particles)
                .map(|i| (1000 + i) as f64)
                .collect::<Vec<_>>()
        );
        assert_eq!(set.value(particles - 1, 1), (1000 + particles - 1) as f64);
    }
}

#[test]
fn advance_copies_whole_ancestors() {
    let n = 20 * BLOCK + 7;
    let ancestors: Vec<u32> = (0..n).map(|i| ((i * 7919 + 3) % n) as u32).collect();
    let mut set = numbered(n, 3);
    set.advance(Some(&ancestors), 0..n.div_ceil(BLOCK), |_, _| ());
    for (i, &ancestor) in ancestors.iter().enumerate() {
        for c in 0..3 {
            assert_eq!(set.value(i, c), f64::from(1000 * c as u32 + ancestor));
        }
    }
}

#[test]
fn append_columns_adds_zeros_and_keeps_the_values() {
    let n = 2 * BLOCK + 5;
    let mut set = numbered(n, 2);
    set.append_columns(0);
    set.append_columns(3);
    assert_eq!((set.len(), set.columns()), (n, 5));
    for i in 0..n {
        let particle: Vec<f64> = (0..5).map(|c| set.value(i, c)).collect();
        assert_eq!(particle, [i as f64, (1000 + i) as f64, 0.0, 0.0, 0.0]);
    }
    // the other half of the double buffer has the new layout too
    let ancestors: Vec<u32> = (0..n as u32).rev().collect();
    set.advance(Some(&ancestors), 0..n.div_ceil(BLOCK), |_, _| ());
    assert_eq!((set.value(0, 1), set.value(0, 4)), ((999 + n) as f64, 0.0));
}

#[test]
fn columns_mut_lends_different_columns_in_the_order_asked() {
    let mut set = numbered(BLOCK + 3, 4);
    set.for_each_block(|block| {
        let [c, a] = block.columns_mut([3, 1]);
        assert_eq!(c.len(), a.len());
        a.copy_from_slice(c);
    });
    assert_eq!(set.value(BLOCK + 2, 1), (3000 + BLOCK + 2) as f64);
}

#[test]
#[should_panic(expected = "columns [1, 1]")]
fn columns_mut_with_a_column_twice_panics() {
    numbered(3, 2).for_each_block(|block| {
        let _ = block.columns_mut([1, 1]);
    });
}

#[test]
fn weighted_circular_std_crosses_the_seam() {
    use stickslip_filter::{Block, BlockMut, Draw, Model};
    struct Angles;
    impl Model for Angles {
        type Input = ();
        type Observation = ();
        type Scratch = ();
        type Sums = ();
        fn columns(&self) -> usize {
            1
        }
        fn scratch(&self) {}
        fn initialise(&self, _: Draw, block: &mut BlockMut<'_>) {
            for (lane, particle) in block.particles() {
                let side = if particle % 2 == 0 { 1.0 } else { -1.0 };
                block.column_mut(0)[lane] = side * (std::f64::consts::PI - 0.1);
            }
        }
        fn propagate(&self, (): &(), _: Draw, _: &mut BlockMut<'_>, (): &mut ()) {}
        fn log_likelihood(&self, (): &(), _: &Block<'_>, _: &mut [f64]) {}
        fn sum(&self, (): &(), _: &Block<'_>, _: &[f64], (): &mut ()) {}
        fn reinitialise(&self, (): &(), _: Draw, _: &mut BlockMut<'_>) {}
    }
    let filter = ParticleFilter::new(Angles, common::settings(100, 0)).unwrap();
    for mean in [std::f64::consts::PI, -std::f64::consts::PI] {
        assert!((filter.weighted_circular_std_about(mean, 0) - 0.1).abs() < 1e-12);
    }
    assert!(filter.expectation(0, |x| x).abs() < 1e-12);
}

#[test]
fn expectation_is_the_weighted_sum_over_all_particles() {
    use crate::common::{Axis, POSITION, VELOCITY};
    let mut filter = ParticleFilter::new(Axis::OPEN, common::settings(3 * BLOCK + 5, 1)).unwrap();
    assert!(!filter.step(&0.1, Some(&0.2)).collapsed());
    let weights = filter.weights().weights();
    for column in [VELOCITY, POSITION] {
        let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
            filter
                .particles()
                .column(column)
                .zip(weights)
                .map(|(x, w)| w * f(x))
                .sum()
        };
        let mean = sum(&|x| x);
        assert!((common::mean(&filter, column) - mean).abs() < 1e-12);
        let std = sum(&|x| (x - mean).powi(2)).sqrt();
        assert!(
            (common::std(&filter, column) - std).abs() < 1e-12 && std > 0.0,
            "{std}"
        );
    }
    assert!(weights.iter().any(|w| *w != weights[0]));
}

#[test]
fn sums_are_those_of_the_weighted_particles_however_the_step_ends() {
    use crate::common::{Axis, POSITION, VELOCITY};
    for particles in [1, BLOCK, 3 * BLOCK + 5] {
        let mut filter = ParticleFilter::new(Axis::GATED, common::settings(particles, 1)).unwrap();
        let mut check = |observation: Option<&f64>, collapses: bool| {
            assert_eq!(filter.step(&0.1, observation).collapsed(), collapses);
            let sums = filter.sums();
            assert!((sums.weight - 1.0).abs() < 1e-12, "{sums:?}");
            for column in [POSITION, VELOCITY] {
                let mean = common::mean(&filter, column);
                let square = filter.expectation(column, |x| x * x);
                assert!((sums.first[column] - mean).abs() < 1e-12, "{sums:?}");
                assert!(
                    (sums.second[column] / square - 1.0).abs() < 1e-12,
                    "{sums:?}"
                );
            }
        };
        check(Some(&0.2), false);
        check(None, false);
        check(Some(&50.0), true);
        check(Some(&50.1), false);
    }
}

#[test]
fn new_with_settings_out_of_range_is_refused() {
    let refuse = |settings| ParticleFilter::new(common::Axis::OPEN, settings).err();
    let none = Settings {
        particles: 0,
        ..Settings::default()
    };
    assert_eq!(
        refuse(none),
        Some(SettingsError::Particles { particles: 0 })
    );
    let above = Settings {
        resample_below: 1.5,
        ..Settings::default()
    };
    assert_eq!(
        refuse(above),
        Some(SettingsError::ResampleBelow { share: 1.5 })
    );
    assert!(
        refuse(Settings {
            resample_below: f64::NAN,
            ..Settings::default()
        })
        .is_some()
    );
    assert_eq!(
        SettingsError::Particles { particles: 0 }.to_string(),
        "`particles` is 0; it must be at least 1 and below 2^32; try 500"
    );
}

#[test]
fn change_model_to_more_columns_keeps_the_particles_and_appends_zeros() {
    use crate::common::Axis;
    let n = BLOCK + 3;
    let mut filter = ParticleFilter::new(Axis::OPEN, common::settings(n, 1)).unwrap();
    let _ = filter.step(&0.1, Some(&0.2));
    let columns = |filter: &ParticleFilter<Axis>| -> Vec<Vec<f64>> {
        let set = filter.particles();
        (0..set.columns())
            .map(|column| set.column(column).collect())
            .collect()
    };
    let mut expected = columns(&filter);
    expected.push(vec![0.0; n]);
    filter.change_model(|model| model.columns = 3);
    assert_eq!(columns(&filter), expected);
    assert!(!filter.step(&0.1, Some(&0.2)).collapsed());
}
