//! Results are equal to the bit on any number of threads.

use crate::common::{Axis, POSITION, VELOCITY, mean, series, settings, std};
use stickslip_filter::{ParticleFilter, Resampling, Settings, StepReport, keep_threads_awake};

const PARTICLES: usize = 5003;

#[derive(Debug, PartialEq)]
struct Outcome {
    reports: Vec<StepReport>,
    /// Bits of particles, weights and moments.
    bits: Vec<u64>,
}

fn run(resampling: Resampling) -> Outcome {
    let (times, measurements) = series(30, 9);
    let settings = Settings {
        resampling,
        ..settings(PARTICLES, 5)
    };
    let mut filter = ParticleFilter::new(Axis::GATED, settings).unwrap();
    let (mut reports, mut bits) = (Vec::new(), Vec::new());
    for row in 1..times.len() {
        // row 20 cannot be explained
        let observation = if row == 20 {
            Some(100.0)
        } else {
            measurements[row]
        };
        reports.push(filter.step(&(times[row] - times[row - 1]), observation.as_ref()));
        bits.extend(numbers(&filter).into_iter().map(f64::to_bits));
    }
    Outcome { reports, bits }
}

fn numbers(filter: &ParticleFilter<Axis>) -> Vec<f64> {
    let mut out: Vec<f64> = [POSITION, VELOCITY]
        .iter()
        .flat_map(|&c| filter.particles().column(c))
        .collect();
    out.extend(filter.weights().weights());
    out.extend(filter.weights().log_weights());
    let direction = circular_mean(filter, POSITION);
    out.push(mean(filter, POSITION));
    out.push(std(filter, VELOCITY));
    out.push(direction);
    out.push(filter.weighted_circular_std_about(direction, POSITION));
    out
}

/// The direction of the weighted mean unit vector of a column of angles [rad].
fn circular_mean(filter: &ParticleFilter<Axis>, column: usize) -> f64 {
    let weights = filter.weights().weights();
    let [sin, cos] = filter.particles().reduce(
        |block| {
            let weighted = block.column(column).iter().zip(&weights[block.range()]);
            weighted.fold([0.0, 0.0], |[s, c], (&angle, w)| {
                let (sin, cos) = libm::sincos(angle);
                [s + w * sin, c + w * cos]
            })
        },
        |a, b| [a[0] + b[0], a[1] + b[1]],
    );
    libm::atan2(sin, cos)
}

#[test]
fn step_on_one_two_three_and_eight_threads_gives_the_same_bits() {
    for resampling in [Resampling::Systematic, Resampling::Residual] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| run(resampling))
        };
        let reference = on(1);
        assert!(reference.reports.iter().any(|r| r.resampled));
        assert!(reference.reports.iter().any(StepReport::collapsed));
        for threads in [2, 3, 8] {
            assert!(
                on(threads) == reference,
                "{threads} threads differ from one, {resampling:?}"
            );
        }
    }
}

#[test]
fn keep_threads_awake_changes_no_bit() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(3)
        .build()
        .unwrap();
    let awake = pool.install(|| keep_threads_awake(|| run(Resampling::Systematic)));
    assert!(awake == run(Resampling::Systematic));
}

#[test]
fn keep_threads_awake_ends_with_a_body_that_panics() {
    let pool = std::panic::AssertUnwindSafe(
        rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .build()
            .unwrap(),
    );
    let ended =
        std::panic::catch_unwind(|| pool.install(|| keep_threads_awake(|| panic!("on purpose"))));
    assert!(ended.is_err());
}

/// FNV-1a over the bits of a run. The number changes where the algorithm or its random numbers
/// change, and then says so; it does not depend on threads, build profile or instruction set.
#[test]
fn step_gives_the_recorded_bits() {
    let run = run(Resampling::Systematic);
    let bytes = run.bits.iter().flat_map(|bits| bits.to_le_bytes());
    let digest = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    assert_eq!(format!("{digest:016x}"), "e4ab820e7a117c5e");
}
