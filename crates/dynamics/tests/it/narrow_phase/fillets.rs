//! Bodies of some centimetres with edges of some micrometres, as a drawing program writes fillets:
//! gaps against the distances of points from segments, in closed form. (Parry is no oracle here: on
//! these it is off by 1e-9 m, against the closed form in 40 digits.)

use stickslip_dynamics::{Part, Pose, Shape};

use super::shapes::{Random, contacts, disc, filleted, random_polygon, shape, smallest};

/// The sides of a polygon at a pose.
fn sides(part: &Part, pose: Pose) -> Vec<[[f64; 2]; 2]> {
    let Part::Polygon { vertices } = part else {
        panic!("no polygon: {part:?}")
    };
    let ends = vertices.iter().zip(vertices.iter().cycle().skip(1));
    ends.map(|(a, b)| [pose.transform(*a), pose.transform(*b)])
        .collect()
}

/// Distance of a point from a segment (m).
fn distance(point: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let [u, v] = [
        [b[0] - a[0], b[1] - a[1]],
        [point[0] - a[0], point[1] - a[1]],
    ];
    let share = ((u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1])).clamp(0.0, 1.0);
    (v[0] - share * u[0]).hypot(v[1] - share * u[1])
}

/// Of points from the nearest of segments (m).
fn nearest(points: impl Iterator<Item = [f64; 2]>, sides: &[[[f64; 2]; 2]]) -> f64 {
    points
        .flat_map(|point| sides.iter().map(move |side| distance(point, *side)))
        .fold(f64::INFINITY, f64::min)
}

/// The corners that sides begin at.
fn corners(sides: &[[[f64; 2]; 2]]) -> impl Iterator<Item = [f64; 2]> {
    sides.iter().map(|[from, _]| *from)
}

fn single(part: &Part) -> Shape {
    shape(vec![part.clone()])
}

fn filleted_polygon(random: &mut Random) -> Part {
    filleted(&random_polygon(random), 1e-5, 8)
}

#[test]
fn discs_are_as_far_from_fillets_as_their_middles_less_the_radius() {
    let mut random = Random(9);
    let mut overlapping = 0;
    for _ in 0..5_000 {
        let part = filleted_polygon(&mut random);
        let (p, q) = (random.pose(0.02), random.pose(0.08));
        let sides = sides(&part, p);
        let middle = [q.x, q.y];
        // right of a side: the middle is outside, where the distance has its sign
        let outside = sides.iter().any(|[a, b]| {
            (b[0] - a[0]) * (middle[1] - a[1]) - (b[1] - a[1]) * (middle[0] - a[0]) < 0.0
        });
        if !outside {
            continue;
        }
        let radius = random.range(0.001, 0.03);
        let probe = single(&disc(radius, [0.0, 0.0]));
        let found = smallest(&contacts((&single(&part), p), (&probe, q), 1.0));
        let expected = nearest([middle].into_iter(), &sides) - radius;
        assert!(
            (found - expected).abs() < 1e-13,
            "{part:?} {p:?} {q:?} {radius}: {found}, not {expected}"
        );
        overlapping += usize::from(expected < 0.0);
    }
    assert!(overlapping > 500, "{overlapping}");
}

#[test]
fn polygons_apart_are_as_far_from_fillets_as_the_nearest_corner_from_a_side() {
    let mut random = Random(10);
    let mut apart = 0;
    for pair in 0..2_000 {
        let part = filleted_polygon(&mut random);
        let other = match pair % 2 {
            0 => random_polygon(&mut random),
            _ => filleted_polygon(&mut random),
        };
        let (p, q) = (random.pose(0.02), random.pose(0.12));
        let found = smallest(&contacts((&single(&part), p), (&single(&other), q), 1.0));
        if found <= 0.0 {
            continue;
        }
        let (a, b) = (sides(&part, p), sides(&other, q));
        let expected = nearest(corners(&a), &b).min(nearest(corners(&b), &a));
        assert!(
            (found - expected).abs() < 1e-13,
            "{part:?} {p:?}\n{other:?} {q:?}: {found}, not {expected}"
        );
        apart += 1;
    }
    assert!(apart > 500, "{apart}");
}
