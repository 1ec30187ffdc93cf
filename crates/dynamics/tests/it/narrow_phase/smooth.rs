//! Polygons that stand for ellipses, and bodies with one centre.

use stickslip_dynamics::{Part, Pose};

use super::shapes::{Random, contacts, disc, random_polygon, shape, smallest};

/// Distance from the ellipse about the origin to a point outside it, by golden section.
fn distance([a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    let at = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        (x - a * cos).hypot(y - b * sin)
    };
    // the nearest point lies in the quadrant of the point
    let start = (libm::atan2(y, x) / std::f64::consts::FRAC_PI_2).floor();
    let [mut low, mut high] = [start, start + 1.0].map(|k| k * std::f64::consts::FRAC_PI_2);
    for _ in 0..80 {
        let (p, q) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if at(p) < at(q) { high = q } else { low = p }
    }
    at(0.5 * (low + high))
}

#[test]
fn ellipse_lies_within_0_02_percent_of_its_longer_axis() {
    let mut random = Random(4);
    let mut deviations = [0.0_f64; 2];
    for _ in 0..1000 {
        let axes = [random.range(0.005, 0.04), random.range(0.005, 0.04)];
        let plate = shape(vec![Part::ellipse(axes, [0.0; 2], 0.0)]);
        let tip = shape(vec![disc(1e-6, [0.0; 2])]);
        let pose = random.pose(0.1);
        if (pose.x / axes[0]).hypot(pose.y / axes[1]) < 1.01 {
            continue;
        }
        let found = contacts((&plate, Pose::default()), (&tip, pose), 1.0);
        let expected = distance(axes, [pose.x, pose.y]) - 1e-6;
        // positive where the polygon lies outside the ellipse
        let deviation = (expected - smallest(&found)) / axes[0].max(axes[1]);
        deviations = [deviations[0].min(deviation), deviations[1].max(deviation)];
    }
    let [inside, outside] = deviations;
    assert!(-1.02e-4 < inside && inside < -0.8e-4, "{inside}");
    assert!(1.6e-4 < outside && outside < 2.04e-4, "{outside}");
}

#[test]
fn concentric_bodies_answer() {
    let parts = [
        disc(0.01, [0.0; 2]),
        Part::ellipse([0.02, 0.01], [0.0; 2], 0.0),
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
