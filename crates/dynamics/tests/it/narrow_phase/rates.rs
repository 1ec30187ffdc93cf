//! The rate of the gap against (n, r × n)·v − n·u: central differences for random twists of both
//! bodies, every pair of kinds.

use stickslip_dynamics::{Gap, Pose, Shape, Twist};

use super::shapes::{Random, contacts, disc, random_polygon, rectangle, shape};

/// Half the time between the two poses of a difference (s).
const H: f64 = 1e-6;

fn kinds(random: &mut Random) -> Vec<Shape> {
    vec![
        shape(vec![disc(0.012, [0.004, -0.002])]),
        shape(vec![random_polygon(random)]),
        shape(vec![
            rectangle([-0.02, 0.04], [-0.02, 0.005]),
            rectangle([-0.02, 0.005], [0.005, 0.04]),
        ]),
        shape(vec![
            rectangle([-0.02, 0.02], [-0.01, 0.01]),
            disc(0.01, [-0.02, 0.0]),
            disc(0.007, [0.02, 0.0]),
        ]),
    ]
}

fn random_twist(random: &mut Random) -> Twist {
    Twist {
        vx: random.range(-0.1, 0.1),
        vy: random.range(-0.1, 0.1),
        omega: random.range(-3.0, 3.0),
    }
}

/// The gap of the contact that is nearest to `contact`; `None` where the features changed.
fn follow(contact: &Gap, among: &[Gap]) -> Option<f64> {
    let near =
        |a: [f64; 2], b: [f64; 2], tolerance: f64| (a[0] - b[0]).hypot(a[1] - b[1]) < tolerance;
    let mut same = among
        .iter()
        .filter(|g| near(g.normal, contact.normal, 1e-3) && near(g.arm, contact.arm, 1e-4));
    same.next()
        .filter(|_| same.next().is_none())
        .map(|gap| gap.gap)
}

#[test]
fn rate_of_the_gap_is_the_speed_of_the_surfaces_along_the_normal() {
    let mut random = Random(1);
    let mut checked = [[0; 4]; 4];
    for _ in 0..3000 {
        let (i, j) = (random.below(4), random.below(4));
        let (object, other) = (&kinds(&mut random)[i], &kinds(&mut random)[j]);
        let poses = [random.pose(0.04), random.pose(0.04)];
        let twists = [random_twist(&mut random), random_twist(&mut random)];
        let at = |t: f64| {
            contacts(
                (object, poses[0].advance(twists[0], t)),
                (other, poses[1].advance(twists[1], t)),
                0.01,
            )
        };
        let (now, before, after) = (at(0.0), at(-H), at(H));
        for contact in now.iter().filter(|contact| contact.gap > -0.002) {
            let (Some(a), Some(b)) = (follow(contact, &before), follow(contact, &after)) else {
                continue;
            };
            let point = [poses[0].x + contact.arm[0], poses[0].y + contact.arm[1]];
            let (v, u) = (
                twists[0].at(contact.arm),
                twists[1].at([point[0] - poses[1].x, point[1] - poses[1].y]),
            );
            let rate = contact.normal[0] * (v[0] - u[0]) + contact.normal[1] * (v[1] - u[1]);
            assert!(
                ((b - a) / (2.0 * H) - rate).abs() < 1e-7,
                "{i} {j} {poses:?} {contact:?}: {} is not {rate}",
                (b - a) / (2.0 * H)
            );
            checked[i][j] += 1;
        }
    }
    assert!(
        checked.as_flattened().iter().all(|&n| n > 10),
        "{checked:?}"
    );
}

#[test]
fn contact_points_lie_on_both_boundaries() {
    let mut random = Random(2);
    let dot = shape(vec![disc(1e-9, [0.0; 2])]);
    for _ in 0..2000 {
        let (i, j) = (random.below(4), random.below(4));
        let (object, other) = (&kinds(&mut random)[i], &kinds(&mut random)[j]);
        let poses = [random.pose(0.04), random.pose(0.04)];
        for contact in contacts((object, poses[0]), (other, poses[1]), 0.01)
            .iter()
            .filter(|contact| contact.gap > 0.0)
        {
            let object_point = [poses[0].x + contact.arm[0], poses[0].y + contact.arm[1]];
            let other_point = [
                object_point[0] - contact.gap * contact.normal[0],
                object_point[1] - contact.gap * contact.normal[1],
            ];
            for (body, [x, y]) in [
                ((object, poses[0]), object_point),
                ((other, poses[1]), other_point),
            ] {
                let found = contacts(body, (&dot, Pose::new(x, y, 0.0)), 1e-4);
                assert!(
                    found.iter().any(|g| g.gap.abs() < 2e-9),
                    "{i} {j} {poses:?} {contact:?}: {found:?}"
                );
            }
        }
    }
}
