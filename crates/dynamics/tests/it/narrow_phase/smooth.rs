//! Ellipses against brute force: the largest separation over finely sampled directions.

use stickslip_dynamics::{Part, Pose};

use super::shapes::{Random, contacts, disc, ellipse, random_polygon, same, shape, smallest};

/// Support function of a placed part: max of n·p.
fn support(part: &Part, pose: Pose, n: [f64; 2]) -> f64 {
    let (sin, cos) = libm::sincos(pose.theta);
    let m = [cos * n[0] + sin * n[1], cos * n[1] - sin * n[0]];
    let dot = |p: &[f64; 2]| m[0] * p[0] + m[1] * p[1];
    let local = match part {
        Part::Polygon { vertices } => vertices.iter().map(dot).fold(f64::NEG_INFINITY, f64::max),
        Part::Disc { radius, centre } => dot(centre) + radius,
        Part::Ellipse {
            semi_axes: [a, b],
            centre,
            angle,
        } => {
            let (s, c) = libm::sincos(*angle);
            dot(centre) + (a * (c * m[0] + s * m[1])).hypot(b * (c * m[1] - s * m[0]))
        }
    };
    n[0] * pose.x + n[1] * pose.y + local
}

/// max over n of −h_B(n) − h_O(−n): the distance, or minus the least penetration, of two convex
/// bodies. Every peak among the samples is refined by golden section.
fn brute_force(object: (&Part, Pose), other: (&Part, Pose)) -> f64 {
    const SAMPLES: usize = 1440;
    let step = std::f64::consts::TAU / SAMPLES as f64;
    let gap = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        -support(other.0, other.1, [cos, sin]) - support(object.0, object.1, [-cos, -sin])
    };
    let sampled: Vec<f64> = (0..SAMPLES).map(|k| gap(k as f64 * step)).collect();
    let peak = |k: &usize| {
        sampled[*k] >= sampled[(k + 1) % SAMPLES]
            && sampled[*k] >= sampled[(k + SAMPLES - 1) % SAMPLES]
    };
    let refined = |k: usize| {
        let (mut low, mut high) = ((k as f64 - 1.0) * step, (k as f64 + 1.0) * step);
        for _ in 0..60 {
            let (p, q) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
            if gap(p) > gap(q) { high = q } else { low = p }
        }
        gap(0.5 * (low + high))
    };
    (0..SAMPLES)
        .filter(peak)
        .map(refined)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Half of them slim, up to a hundredth.
fn random_ellipse(random: &mut Random) -> Part {
    let a = random.range(0.01, 0.04);
    let slimmest = if random.below(2) == 0 { 0.01 } else { 0.3 };
    let b = a * random.range(slimmest, 1.0);
    let axes = if random.below(2) == 0 { [a, b] } else { [b, a] };
    ellipse(
        axes,
        [random.range(-0.01, 0.01), random.range(-0.01, 0.01)],
        random.range(-4.0, 4.0),
    )
}

/// Checks pairs that are apart and pairs in overlap: one contact each, as deep as brute force says.
fn compare(seed: u64, parts: impl Fn(&mut Random) -> [Part; 2]) {
    let mut random = Random(seed);
    let (mut apart, mut overlapping) = (0, 0);
    for _ in 0..2500 {
        let [a, b] = parts(&mut random);
        let [object, other] = [a.clone(), b.clone()].map(|part| shape(vec![part]));
        let [p, q] = [random.pose(0.05), random.pose(0.05)];
        let expected = brute_force((&a, p), (&b, q));
        let found = contacts((&object, p), (&other, q), 1.0);
        assert!(
            found.len() == 1 && (found[0].gap - expected).abs() < 1e-12,
            "{a:?} {p:?}\n{b:?} {q:?}\n{found:?}, not {expected}"
        );
        if expected > 0.0 {
            apart += 1
        } else {
            overlapping += 1
        }
    }
    assert!(apart > 500 && overlapping > 200, "{apart} {overlapping}");
}

#[test]
fn ellipse_pairs_match_brute_force() {
    compare(1, |r| [random_ellipse(r), random_ellipse(r)]);
}

#[test]
fn ellipse_and_polygon_match_brute_force() {
    compare(2, |r| [random_ellipse(r), random_polygon(r)]);
    compare(3, |r| [random_polygon(r), random_ellipse(r)]);
}

#[test]
fn ellipse_and_disc_match_brute_force() {
    compare(4, |r| {
        [random_ellipse(r), disc(r.range(0.001, 0.02), [0.003, 0.0])]
    });
    compare(5, |r| {
        [disc(r.range(0.001, 0.02), [0.003, 0.0]), random_ellipse(r)]
    });
}

#[test]
fn a_round_ellipse_is_a_disc() {
    let (round, same_disc) = (
        shape(vec![ellipse([0.02; 2], [0.003, 0.004], 0.7)]),
        shape(vec![disc(0.02, [0.003, 0.004])]),
    );
    let mut random = Random(6);
    for k in 0..2000 {
        let (tip, pose) = (
            shape(vec![if k % 2 == 0 {
                random_polygon(&mut random)
            } else {
                disc(0.01, [0.0; 2])
            }]),
            random.pose(0.05),
        );
        let [a, b] = [&round, &same_disc]
            .map(|object| contacts((object, Pose::default()), (&tip, pose), 0.01));
        assert!(same(&a, &b, 1e-9), "{pose:?} {a:?} {b:?}");
    }
}

#[test]
fn concentric_discs_and_ellipses_answer() {
    let parts = [
        disc(0.01, [0.0; 2]),
        ellipse([0.02, 0.01], [0.0; 2], 0.0),
        ellipse([0.01; 2], [0.0; 2], 0.0),
        random_polygon(&mut Random(1)),
    ];
    for (k, a) in parts.iter().enumerate() {
        for b in &parts[..=k] {
            let found = contacts(
                (&shape(vec![a.clone()]), Pose::default()),
                (&shape(vec![b.clone()]), Pose::default()),
                0.001,
            );
            assert!(
                !found.is_empty() && smallest(&found) < -0.01,
                "{a:?} {b:?} {found:?}"
            );
        }
    }
}
