//! Laws that hold for any shapes: faces, corners, frames, roles, order.

use stickslip_dynamics::{Gap, Placed, Pose, Shape, narrow_phase};

use super::shapes::{
    Random, contacts, disc, polygon, random_polygon, random_polygon_of_many, rectangle, same,
    shape, smallest,
};

fn random_shape(random: &mut Random) -> Shape {
    let part = match random.below(3) {
        0 => disc(random.range(0.002, 0.03), [random.range(-0.01, 0.01), 0.0]),
        1 => {
            return shape(vec![
                rectangle([-0.02, 0.04], [-0.02, 0.005]),
                rectangle([-0.02, 0.005], [0.005, 0.04]),
            ]);
        }
        _ => random_polygon(random),
    };
    shape(vec![part])
}

#[test]
fn faces_that_meet_touch_at_two_points() {
    let square = shape(vec![rectangle([-0.025, 0.025], [-0.025, 0.025])]);
    for half in [0.01, 0.025, 0.04] {
        let block = shape(vec![rectangle([-half, half], [-0.01, 0.01])]);
        for shift in [0.0, 1e-12, 1e-7, 0.003, 0.02] {
            for tilt in [0.0, 1e-9, -1e-6, 1e-3, -1e-3] {
                for gap in [1e-3, 1e-9, 0.0, -1e-6] {
                    // the lower corner of the tilted block is `gap` above the face
                    let low = half * libm::fabs(libm::sin(tilt)) + 0.01 * libm::cos(tilt);
                    let pose = Pose::new(shift, 0.025 + gap + low, tilt);
                    let found = contacts((&square, Pose::default()), (&block, pose), 2e-3);
                    let context =
                        format!("half {half}, shift {shift}, tilt {tilt}, gap {gap}: {found:?}");
                    assert_eq!(found.len(), 2, "{context}");
                    assert!(
                        (found[0].arm[0] - found[1].arm[0]).abs() > half * 0.9
                            && found.iter().all(|g| g.normal[1] < -0.99),
                        "{context}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_gap_is_continuous_round_a_corner() {
    let square = shape(vec![rectangle([-0.025, 0.025], [-0.025, 0.025])]);
    let probes = [
        disc(0.004, [0.0; 2]),
        disc(1e-6, [0.0; 2]),
        polygon(&[[-0.01, -0.01], [0.01, -0.01], [0.0, 0.02]]),
    ];
    for probe in probes {
        let probe = shape(vec![probe]);
        for gap in [1e-3, 1e-6, 0.0, -1e-5] {
            // along the top face, past the corner, on the line height = const
            let start = smallest(&contacts(
                (&square, Pose::default()),
                (&probe, Pose::new(0.0, 0.06, 0.3)),
                1.0,
            ));
            let at = |x: f64| {
                smallest(&contacts(
                    (&square, Pose::default()),
                    (&probe, Pose::new(x, 0.06 - start + gap, 0.3)),
                    1.0,
                ))
            };
            let mut last = at(0.0);
            for k in 1..=40_000 {
                let next = at(0.04 * f64::from(k) / 40_000.0);
                assert!(
                    (next - last).abs() <= 1.01e-6,
                    "gap {gap}, step {k}: {last} to {next}"
                );
                last = next;
            }
        }
    }
}

#[test]
fn moving_and_turning_the_scene_changes_nothing() {
    let mut random = Random(1);
    for _ in 0..5000 {
        let (a, b) = (random_shape(&mut random), random_shape(&mut random));
        let (p, q, by) = (random.pose(0.04), random.pose(0.04), random.pose(1.0));
        let moved = |pose: Pose| {
            let [x, y] = by.transform([pose.x, pose.y]);
            Pose::new(x, y, pose.theta + by.theta)
        };
        let turned = |g: &Gap| Gap {
            normal: by.rotate(g.normal),
            arm: by.rotate(g.arm),
            gap: g.gap,
        };
        let before: Vec<Gap> = contacts((&a, p), (&b, q), 0.005)
            .iter()
            .map(turned)
            .collect();
        let after = contacts((&a, moved(p)), (&b, moved(q)), 0.005);
        assert!(
            same(&before, &after, 1e-11),
            "{p:?} {q:?} {by:?}\n{before:?}\n{after:?}"
        );
    }
}

#[test]
fn swapping_the_bodies_mirrors_the_contacts() {
    let mut random = Random(2);
    for _ in 0..5000 {
        let (a, b) = (random_shape(&mut random), random_shape(&mut random));
        let (p, q) = (random.pose(0.04), random.pose(0.04));
        let mirrored = |g: &Gap| {
            let arm =
                [0, 1].map(|k| [p.x, p.y][k] + g.arm[k] - g.gap * g.normal[k] - [q.x, q.y][k]);
            Gap {
                normal: [-g.normal[0], -g.normal[1]],
                arm,
                gap: g.gap,
            }
        };
        let here: Vec<Gap> = contacts((&a, p), (&b, q), 0.005)
            .iter()
            .map(mirrored)
            .collect();
        let there = contacts((&b, q), (&a, p), 0.005);
        assert!(
            same(&here, &there, 1e-10),
            "{a:?} {p:?} {b:?} {q:?}\n{here:?}\n{there:?}"
        );
    }
}

#[test]
fn contacts_are_appended_and_fewer_within_a_shorter_search_distance() {
    let mut random = Random(3);
    for round in 0..3000 {
        let (a, b) = (random_shape(&mut random), random_shape(&mut random));
        let a = if round % 3 == 0 {
            shape(vec![random_polygon_of_many(&mut random)])
        } else {
            a
        };
        let (p, q) = (
            Placed::new(&a, random.pose(0.04)),
            Placed::new(&b, random.pose(0.04)),
        );
        let mut out = Vec::new();
        narrow_phase(&p, &q, 0.01, &mut out);
        let wide = out.clone();
        narrow_phase(&p, &q, 0.002, &mut out);
        let (first, narrow) = out.split_at(wide.len());
        assert_eq!(first, wide);
        let expected: Vec<Gap> = wide.iter().copied().filter(|g| g.gap < 0.002).collect();
        assert!(same(&expected, narrow, 0.0), "{wide:?} {narrow:?}");
    }
}
