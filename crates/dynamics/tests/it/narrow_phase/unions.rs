//! Unions: a body touches alike however it is cut into parts.

use stickslip_dynamics::{Gap, Part, Pose, Shape};

use super::shapes::{Random, contacts, disc, filleted, polygon, rectangle, same, shape, smallest};

/// A rectangle whole, cut along one seam, with a T of seams, along a diagonal, into overlapping
/// parts, and with a nested part.
fn rectangles() -> Vec<Shape> {
    let (x, y) = ([-0.03, 0.03], [-0.02, 0.02]);
    vec![
        shape(vec![rectangle(x, y)]),
        shape(vec![
            rectangle([-0.03, 0.004], y),
            rectangle([0.004, 0.03], y),
        ]),
        shape(vec![
            rectangle(x, [-0.02, 0.005]),
            rectangle([-0.03, 0.01], [0.005, 0.02]),
            rectangle([0.01, 0.03], [0.005, 0.02]),
        ]),
        shape(vec![
            polygon(&[[-0.03, -0.02], [0.03, -0.02], [0.03, 0.02]]),
            polygon(&[[-0.03, -0.02], [0.03, 0.02], [-0.03, 0.02]]),
        ]),
        shape(vec![
            rectangle([-0.03, 0.01], y),
            rectangle([-0.004, 0.03], y),
        ]),
        shape(vec![
            rectangle(x, y),
            rectangle([-0.01, 0.02], [-0.02, 0.01]),
            disc(0.01, [0.0; 2]),
            Part::ellipse([0.02, 0.01], [0.0; 2], 0.3),
        ]),
    ]
}

/// An L cut either way, and as two overlapping bars.
fn ells() -> Vec<Shape> {
    let (wide, high) = (
        rectangle([-0.02, 0.04], [-0.02, 0.005]),
        rectangle([-0.02, 0.005], [0.005, 0.04]),
    );
    let (short, tall) = (
        rectangle([0.005, 0.04], [-0.02, 0.005]),
        rectangle([-0.02, 0.005], [-0.02, 0.04]),
    );
    vec![
        shape(vec![wide.clone(), high.clone()]),
        shape(vec![short, tall.clone()]),
        shape(vec![high, wide.clone()]),
        shape(vec![tall, wide]),
    ]
}

fn probes() -> Vec<Shape> {
    let parts = [
        disc(0.005, [0.0; 2]),
        disc(1e-4, [0.0; 2]),
        rectangle([-0.004, 0.004], [-0.02, 0.02]),
        polygon(&[[-0.003, -0.003], [0.005, -0.002], [-0.001, 0.004]]),
    ];
    parts.into_iter().map(|part| shape(vec![part])).collect()
}

/// Returns true if a probe's contacts say that it overlaps by less than `depth`.
fn shallow(object: &Shape, probe: (&Shape, Pose), depth: f64) -> bool {
    smallest(&contacts((object, Pose::default()), probe, 0.01)) > -depth
}

/// Every probe at random places touches all `shapes` alike, as object and as the other body.
///
/// A whole convex polygon in overlap with another one reports no gap deeper than the least
/// penetration; a union may. So polygons are compared in overlap only where all the shapes are
/// unions.
fn touch_alike(shapes: &[Shape], seed: u64) {
    let polygonal = |probe: &Shape| matches!(probe.parts()[0], Part::Polygon { .. });
    let mut random = Random(seed);
    let mut touched = 0;
    for probe in &probes() {
        for _ in 0..4000 {
            let pose = random.pose(0.06);
            let depth = if polygonal(probe) && shapes[0].parts().len() == 1 {
                0.0
            } else {
                1e-3
            };
            if !shallow(&shapes[0], (probe, pose), depth) {
                continue;
            }
            for (k, cut) in shapes.iter().enumerate() {
                for (a, b) in [
                    ((&shapes[0], Pose::default()), (probe, pose)),
                    ((probe, pose), (&shapes[0], Pose::default())),
                ] {
                    let swap = |body: (&Shape, Pose)| std::ptr::eq(body.0, &shapes[0]);
                    let (whole, parts) = (
                        contacts(a, b, 0.003),
                        contacts(
                            if swap(a) { (cut, a.1) } else { a },
                            if swap(b) { (cut, b.1) } else { b },
                            0.003,
                        ),
                    );
                    assert!(
                        same(&whole, &parts, 1e-9),
                        "cut {k}, {pose:?}:\n{whole:#?}\n{parts:#?}"
                    );
                    touched += whole.len();
                }
            }
        }
    }
    assert!(touched > 5_000, "{touched}");
}

#[test]
fn a_rectangle_touches_alike_however_it_is_cut() {
    touch_alike(&rectangles(), 1);
}

/// A rectangle with fillets of 2 µm edges, whole, cut along a seam, and as overlapping parts.
#[test]
fn fillets_touch_alike_however_the_body_is_cut() {
    let y = [-0.02, 0.02];
    let whole = filleted(&rectangle([-0.03, 0.03], y), 1e-5, 8);
    let Part::Polygon { vertices } = &whole else {
        unreachable!()
    };
    let part = |x: [f64; 2]| {
        let left = x[1] < 0.02;
        let own = vertices.iter().copied().filter(|v| (v[0] < 0.0) == left);
        // the fillets lie on one side; the cut closes the other
        let (lower, upper): (Vec<_>, Vec<_>) = own.partition(|v| v[1] < 0.0);
        let closed = if left {
            [lower, vec![[x[1], y[0]], [x[1], y[1]]], upper]
        } else {
            [
                vec![[x[0], y[0]]],
                [lower, upper].concat(),
                vec![[x[0], y[1]]],
            ]
        };
        polygon(&closed.concat())
    };
    let shapes = [
        shape(vec![whole.clone()]),
        shape(vec![part([-0.03, 0.004]), part([0.004, 0.03])]),
        shape(vec![part([-0.03, 0.01]), part([-0.004, 0.03])]),
    ];
    touch_alike(&shapes, 3);
}

#[test]
fn an_ell_touches_alike_however_it_is_cut() {
    touch_alike(&ells(), 2);
}

#[test]
fn disc_along_a_straight_seam_touches_one_edge() {
    let ell = &ells()[0];
    let tip = shape(vec![disc(0.003, [0.0; 2])]);
    for k in 0..=1000 {
        let y = -0.0199 + 0.0598 * f64::from(k) / 1000.0;
        for gap in [1e-3, 0.0, -1e-5, -1e-3] {
            let found = contacts(
                (ell, Pose::default()),
                (&tip, Pose::new(-0.023 - gap, y, 0.3)),
                0.002,
            );
            assert_eq!(found.len(), 1, "y = {y}: {found:?}");
            assert!((found[0].gap - gap).abs() < 1e-15 && found[0].normal == [1.0, 0.0]);
            assert!((found[0].arm[0] + 0.02).abs() < 1e-15 && (found[0].arm[1] - y).abs() < 1e-15);
        }
    }
}

#[test]
fn disc_in_a_reentrant_corner_touches_both_edges() {
    for ell in &ells() {
        for (radius, gap) in [(0.005, 1e-4), (0.005, -1e-4), (1e-5, 1e-4), (1e-5, -1e-4)] {
            let tip = shape(vec![disc(radius, [0.0; 2])]);
            let at = 0.005 + radius + gap;
            let mut found = contacts(
                (ell, Pose::default()),
                (&tip, Pose::new(at, at, 0.0)),
                0.001,
            );
            found.sort_by(|a, b| a.normal[0].total_cmp(&b.normal[0]));
            let along =
                |g: &Gap, n: [f64; 2]| (g.normal[0] - n[0]).hypot(g.normal[1] - n[1]) < 1e-12;
            assert!(
                found.len() == 2 && along(&found[0], [-1.0, 0.0]) && along(&found[1], [0.0, -1.0]),
                "{found:?}"
            );
            assert!(found.iter().all(|g| (g.gap - gap).abs() < 1e-15));
        }
    }
}

#[test]
fn a_corner_pushed_into_a_reentrant_corner_touches_both_edges() {
    let square = shape(vec![rectangle([0.0, 0.01], [0.0, 0.01])]);
    for ell in &ells() {
        for gap in [1e-4, 0.0, -1e-6, -1e-4] {
            let found = contacts(
                (&square, Pose::new(0.005 + gap, 0.005 + gap, 0.0)),
                (ell, Pose::default()),
                5e-4,
            );
            assert!(
                found.len() >= 2 && found.iter().all(|g| (g.gap - gap).abs() < 1e-12),
                "{gap}: {found:?}"
            );
            let along =
                |g: &Gap, n: [f64; 2]| (g.normal[0] - n[0]).hypot(g.normal[1] - n[1]) < 1e-12;
            assert!(
                [[1.0, 0.0], [0.0, 1.0]]
                    .iter()
                    .all(|n| found.iter().any(|g| along(g, *n))),
                "{gap}: {found:?}"
            );
        }
    }
}

#[test]
fn rounding_to_a_micrometre_leaves_no_seam() {
    let (c, s) = (libm::cos(0.3), libm::sin(0.3));
    let rounded = |part: Part| {
        let Part::Polygon { vertices } = part else {
            unreachable!()
        };
        let turn = |v: &[f64; 2]| {
            [c * v[0] - s * v[1], s * v[0] + c * v[1]].map(|x| (x * 1e6).round() / 1e6)
        };
        polygon(&vertices.iter().map(turn).collect::<Vec<_>>())
    };
    let y = [-0.02, 0.02];
    let parts = vec![
        rectangle([-0.03, -0.007], y),
        rectangle([-0.007, 0.013], y),
        rectangle([0.013, 0.03], [-0.02, 0.003]),
        rectangle([0.013, 0.03], [0.003, 0.02]),
    ];
    let cut = shape(parts.into_iter().map(rounded).collect());
    let tip = shape(vec![disc(0.004, [0.0; 2])]);
    for k in 0..=2000 {
        for gap in [3e-4, -3e-4] {
            let [x, y] = [-0.0299 + 0.0598 * f64::from(k) / 2000.0, -0.024 - gap];
            let found = contacts(
                (&cut, Pose::default()),
                (&tip, Pose::new(c * x - s * y, s * x + c * y, 0.0)),
                0.002,
            );
            assert!(
                found.len() == 1 && (found[0].gap - gap).abs() < 2e-6,
                "x = {x}: {found:?}"
            );
            assert!((found[0].normal[0] + s).abs() < 2e-4 && (found[0].normal[1] - c).abs() < 2e-4);
        }
    }
}

#[test]
fn a_stadium_of_rectangle_and_discs_has_no_corners() {
    let stadium = shape(vec![
        rectangle([-0.02, 0.02], [-0.01, 0.01]),
        disc(0.01, [-0.02, 0.0]),
        disc(0.01, [0.02, 0.0]),
    ]);
    let tip = shape(vec![disc(0.003, [0.0; 2])]);
    let mut random = Random(5);
    for _ in 0..20_000 {
        let pose = random.pose(0.05);
        let spine = pose.x.clamp(-0.02, 0.02);
        let expected = (pose.x - spine).hypot(pose.y) - 0.013;
        if expected.abs() < 2e-3 {
            let found = contacts((&stadium, Pose::default()), (&tip, pose), 0.003);
            assert!(
                found.len() == 1 && (found[0].gap - expected).abs() < 1e-15,
                "{pose:?}: {found:?}"
            );
        }
    }
}

#[test]
fn the_back_of_a_thin_bar_is_never_a_contact() {
    let bar = shape(vec![rectangle([-0.02, 0.02], [-0.0005, 0.0005])]);
    let tip = shape(vec![disc(0.003, [0.0; 2])]);
    for height in [0.003, 0.002, 1e-3, 2e-4, 1e-9] {
        let found = contacts(
            (&bar, Pose::default()),
            (&tip, Pose::new(0.001, 0.0005 + height, 0.0)),
            0.01,
        );
        assert!(
            found.len() == 1 && found[0].normal == [0.0, -1.0],
            "{height}: {found:?}"
        );
    }
}
