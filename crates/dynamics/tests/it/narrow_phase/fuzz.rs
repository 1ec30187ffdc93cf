//! Any valid shapes at any finite poses: no panic, finite contacts with unit normals, all gaps
//! below the search distance.

use proptest::prelude::*;
use stickslip_dynamics::{Part, Placed, Pose, Shape, narrow_phase};

use super::shapes::{disc, polygon, rectangle, shape};

/// Parts on a coarse grid, so that edges are shared, corners coincide and parts nest.
fn part() -> impl Strategy<Value = Part> {
    let grid = || (-4i32..=4).prop_map(|k| 0.01 * f64::from(k));
    let size = || (1i32..=4).prop_map(|k| 0.01 * f64::from(k));
    prop_oneof![
        (size(), grid(), grid()).prop_map(|(r, x, y)| disc(r, [x, y])),
        (grid(), grid(), size(), size()).prop_map(|(x, y, w, h)| rectangle([x, x + w], [y, y + h])),
        (grid(), grid(), size(), size()).prop_map(|(x, y, w, h)| polygon(&[
            [x, y],
            [x + w, y],
            [x, y + h]
        ])),
        (grid(), grid(), 1e-6..0.1, 3usize..30).prop_map(|(x, y, r, n)| {
            let vertex = |k: usize| libm::sincos(std::f64::consts::TAU * k as f64 / n as f64);
            polygon(
                &(0..n)
                    .map(vertex)
                    .map(|(s, c)| [x + r * c, y + r * s])
                    .collect::<Vec<_>>(),
            )
        }),
    ]
}

fn body() -> impl Strategy<Value = Vec<Part>> {
    prop::collection::vec(part(), 1..5)
}

/// Poses on the grid of the parts, anywhere near, and anywhere.
fn pose() -> impl Strategy<Value = Pose> {
    let grid = (-8i32..=8, -8i32..=8, -4i32..=4).prop_map(|(x, y, k)| {
        Pose::new(
            0.01 * f64::from(x),
            0.01 * f64::from(y),
            0.25 * std::f64::consts::PI * f64::from(k),
        )
    });
    let near = (-0.1..0.1, -0.1..0.1, -10.0..10.0).prop_map(|(x, y, theta)| Pose::new(x, y, theta));
    let far = (
        prop::num::f64::NORMAL,
        prop::num::f64::NORMAL,
        prop::num::f64::NORMAL,
    )
        .prop_map(|(x, y, theta)| Pose::new(x, y, theta));
    prop_oneof![4 => grid, 4 => near, 1 => far]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn contacts_are_finite_with_unit_normals(a in body(), b in body(), p in pose(), q in pose(), search_distance in prop_oneof![-0.05..0.1, Just(f64::INFINITY)]) {
        let (a, b) = (shape(a), shape(b));
        let mut out = Vec::new();
        narrow_phase(&Placed::new(&a, p), &Placed::new(&b, q), search_distance, &mut out);
        for gap in &out {
            let [x, y] = gap.normal;
            // far from the origin the bodies' offset itself is rounded, and may overflow
            let near = p.x.abs().max(p.y.abs()).max(q.x.abs()).max(q.y.abs()) < 1e3;
            prop_assert!(!near || (x.hypot(y) - 1.0).abs() < 1e-12, "{gap:?}");
            prop_assert!(!near || gap.arm.iter().all(|r| r.abs() < 1.0), "{gap:?}");
            prop_assert!(gap.gap < search_distance || !near, "{gap:?}");
        }
    }

    #[test]
    fn overlap_is_never_free(a in body(), b in body(), p in pose(), q in pose()) {
        let (a, b) = (shape(a), shape(b));
        // a body's own points, the centres of its parts, inside the other one
        let inside = |body: &Shape, pose: Pose, point: [f64; 2]| {
            let dot = shape(vec![disc(1e-9, [0.0; 2])]);
            let mut out = Vec::new();
            narrow_phase(&Placed::new(body, pose), &Placed::new(&dot, Pose::new(point[0], point[1], 0.0)), 0.0, &mut out);
            out.iter().any(|gap| gap.gap < -1e-6)
        };
        let centre = |part: &Part| match part {
            Part::Polygon { vertices } => [0, 1].map(|k| vertices.iter().map(|v| v[k]).sum::<f64>() / vertices.len() as f64),
            Part::Disc { centre, .. } => *centre,
        };
        let overlap = b.parts().iter().any(|part| inside(&a, p, q.transform(centre(part))));
        let mut out = Vec::new();
        narrow_phase(&Placed::new(&a, p), &Placed::new(&b, q), 0.0, &mut out);
        prop_assert!(!overlap || out.iter().any(|gap| gap.gap < 0.0), "{:?}", out);
    }
}
