//! Deep overlap: a large disc that holds a whole part of a union.

use stickslip_dynamics::{Part, Pose, Shape};

use super::shapes::{Random, contacts, disc, polygon, rectangle, shape, smallest};

/// Directions that are tried.
const DIRECTIONS: usize = 720;

/// Error of a distance that their spacing may cause (m): half the largest radius
/// times half the spacing squared.
const SPACING: f64 = 1e-6;

/// An L of two bars, a small one at the end of a large one, and a notched block of triangles.
fn unions() -> Vec<Shape> {
    let small = |x: f64| rectangle([x, x + 0.012], [-0.006, 0.006]);
    vec![
        shape(vec![
            rectangle([-0.02, 0.04], [-0.02, -0.01]),
            rectangle([-0.02, -0.01], [-0.01, 0.04]),
        ]),
        shape(vec![rectangle([-0.03, 0.0], [-0.03, 0.03]), small(0.0)]),
        shape(vec![small(0.0), small(0.012), small(0.024)]),
        shape(vec![
            polygon(&[[-0.03, -0.02], [0.0, -0.02], [0.0, 0.005]]),
            polygon(&[[0.0, -0.02], [0.03, -0.02], [0.0, 0.005]]),
        ]),
    ]
}

/// Distance of a disc to each part, by the direction that separates the two most; negative is the
/// least penetration.
fn distances(union: &Shape, radius: f64, pose: Pose) -> Vec<f64> {
    let distance = |part: &Part| {
        let Part::Polygon { vertices } = part else {
            unreachable!()
        };
        let next = vertices.iter().cycle().skip(1);
        let sides = vertices
            .iter()
            .zip(next)
            .map(|(p, q)| libm::atan2(-(q[0] - p[0]), q[1] - p[1]));
        let around = (0..DIRECTIONS).map(|k| std::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
        // out of the part along a direction: where the disc begins, less where the part ends
        let separation = |angle: f64| {
            let (y, x) = libm::sincos(angle);
            let round = x * pose.x + y * pose.y - radius;
            round
                - vertices
                    .iter()
                    .map(|p| x * p[0] + y * p[1])
                    .fold(f64::NEG_INFINITY, f64::max)
        };
        sides
            .chain(around)
            .map(separation)
            .fold(f64::NEG_INFINITY, f64::max)
    };
    union.parts().iter().map(distance).collect()
}

/// Wherever a disc overlaps a union there is a contact that says so. Where there is but one, and
/// its centre is outside, it is a way out: the disc, moved along it by the gap, has left a
/// part that it overlapped.
#[test]
fn a_disc_about_a_part_touches_the_union() {
    let mut random = Random(11);
    let (mut overlapping, mut alone) = (0, 0);
    for union in unions() {
        for radius in [0.012, 0.02, 0.03, 0.05] {
            let round = shape(vec![disc(radius, [0.0; 2])]);
            for _ in 0..600 {
                let pose = random.pose(0.05);
                let before = distances(&union, radius, pose);
                if before.iter().all(|distance| *distance > -1e-4) {
                    continue;
                }
                overlapping += 1;
                let (here, there) = ((&union, Pose::default()), (&round, pose));
                let found = contacts(here, there, 1e-3);
                assert!(
                    smallest(&found) < 0.0 && smallest(&contacts(there, here, 1e-3)) < 0.0,
                    "{radius} {pose:?}: {found:?}"
                );
                let outside = distances(&union, 0.0, pose)
                    .iter()
                    .all(|distance| *distance > 0.0);
                if let [only] = found[..]
                    && outside
                {
                    alone += 1;
                    let [nx, ny] = only.normal;
                    let out = Pose::new(pose.x + only.gap * nx, pose.y + only.gap * ny, pose.theta);
                    let after = distances(&union, radius, out);
                    let left = before
                        .iter()
                        .zip(&after)
                        .any(|(before, after)| *before < -1e-4 && *after > -SPACING);
                    assert!(left, "{radius} {pose:?}: {only:?}\n{before:?}\n{after:?}");
                }
            }
        }
    }
    assert!(overlapping > 3000 && alone > 500, "{overlapping} {alone}");
}
