//! Random streams: pure functions of their arguments, standard normal, uniform, and independent of
//! each other.

use stickslip_filter::{Purpose, Streams};

const N: u32 = 200_000;

#[test]
fn normals_from_any_first_draw_are_the_single_numbers() {
    let draw = Streams::new(u64::MAX).at(1 << 55);
    for first in 0..4 {
        let several = draw.normals::<5>(77, first);
        for (i, x) in several.into_iter().enumerate() {
            assert_eq!(x.to_bits(), draw.normal(77, first + i as u32).to_bits());
        }
    }
}

#[test]
fn normal_columns_of_any_length_are_the_single_numbers_bit_for_bit() {
    let draw = Streams::new(5).of(Purpose::Propagate).at(9);
    for len in [0, 1, 7, 8, 9, 64, 1000] {
        let (mut even, mut odd) = (vec![0.0; len], vec![0.0; len]);
        draw.normal_columns(100, 3, &mut even, &mut odd);
        for (lane, particle) in (0..len).zip(100..) {
            let [a, b] = draw.normals(particle, 6);
            assert_eq!(
                [even[lane].to_bits(), odd[lane].to_bits()],
                [a.to_bits(), b.to_bits()]
            );
        }
    }
}

/// |z| of a sample mean whose terms have the variance given.
fn z(terms: impl Iterator<Item = f64>, mean: f64, variance: f64) -> f64 {
    let sum: f64 = terms.map(|x| x - mean).sum();
    (sum / (f64::from(N) * variance).sqrt()).abs()
}

#[test]
fn normal_has_the_moments_of_the_standard_normal() {
    let draw = Streams::new(1).at(4);
    let powers = |k: i32| (0..N).map(move |i| draw.normal(i, 1).powi(k));
    // moments 1 to 4 are 0, 1, 0, 3; their terms have the variances 1, 2, 15, 96
    for (k, mean, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
        assert!(z(powers(k), mean, variance) < 4.0, "moment {k}");
    }
}

#[test]
fn normal_tails_have_the_probability_of_the_standard_normal() {
    let draw = Streams::new(2).at(0);
    for (bound, tail) in [
        (0.5, 0.308_537_538_7),
        (1.0, 0.158_655_253_9),
        (2.0, 0.022_750_131_9),
        (3.0, 0.001_349_898_0),
    ] {
        let above = (0..N).map(|i| f64::from(u8::from(draw.normal(i, 0) > bound)));
        assert!(z(above, tail, tail * (1.0 - tail)) < 4.0, "above {bound}");
    }
}

#[test]
fn uniform_is_uniform_and_inside_the_open_interval() {
    let draw = Streams::new(3).at(0);
    let all = || (0..N).map(|i| draw.uniform(i, 5));
    assert!(all().all(|u| u > 0.0 && u < 1.0));
    assert!(z(all(), 0.5, 1.0 / 12.0) < 4.0);
    for cell in 0..16 {
        let inside = all().map(|u| f64::from(u8::from((u * 16.0) as i32 == cell)));
        assert!(z(inside, 1.0 / 16.0, 15.0 / 256.0) < 4.0, "cell {cell}");
    }
}

#[test]
fn streams_that_differ_in_one_argument_are_uncorrelated() {
    let (streams, step, draw) = (Streams::new(8), 6, 2);
    let base = |i: u32| streams.normal(step, i, draw);
    let others: [(&str, &dyn Fn(u32) -> f64); 7] = [
        ("seed", &|i| Streams::new(9).normal(step, i, draw)),
        ("high seed", &|i| {
            Streams::new(8 | 1 << 40).normal(step, i, draw)
        }),
        ("purpose", &|i| {
            streams.of(Purpose::Reinitialise).normal(step, i, draw)
        }),
        ("step", &|i| streams.normal(step + 1, i, draw)),
        ("high step", &|i| streams.normal(step | 1 << 50, i, draw)),
        ("particle", &|i| streams.normal(step, i + 1, draw)),
        ("pair partner", &|i| streams.normal(step, i, draw + 1)),
    ];
    for (name, other) in others {
        assert!(
            z((0..N).map(|i| base(i) * other(i)), 0.0, 1.0) < 4.0,
            "{name}"
        );
        assert!(
            z((0..N).map(|i| base(i).powi(2) * other(i).powi(2)), 1.0, 8.0) < 4.0,
            "{name}, squares"
        );
    }
    let uniform = |i| streams.uniform(step, i, draw) - 0.5;
    assert!(
        z((0..N).map(|i| base(i) * uniform(i)), 0.0, 1.0 / 12.0) < 4.0,
        "kind"
    );
}

#[test]
#[should_panic(expected = "does not fit")]
fn at_with_a_step_beyond_the_counter_panics() {
    let _ = Streams::new(0).at(1 << 56);
}
