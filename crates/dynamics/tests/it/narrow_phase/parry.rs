//! Signed distance of convex pairs against `parry2d-f64`, an independent implementation (GJK and
//! EPA).

use parry2d_f64::math::{Pose as Isometry, Vector};
use parry2d_f64::query::contact;
use parry2d_f64::shape::{Ball, ConvexPolygon, Shape as ParryShape};
use stickslip_dynamics::{Part, Pose, Shape};

use super::shapes::{
    Random, contacts, disc, random_polygon, random_polygon_of_many, rectangle, shape, smallest,
};

/// Parry's shape with its offset from the body frame.
fn parry(part: &Part) -> (Box<dyn ParryShape>, [f64; 2]) {
    match part {
        Part::Polygon { vertices } => {
            let points = vertices.iter().map(|v| Vector::new(v[0], v[1])).collect();
            (
                Box::new(ConvexPolygon::from_convex_polyline(points).expect("a convex polygon")),
                [0.0; 2],
            )
        }
        Part::Disc { radius, centre } => (Box::new(Ball::new(*radius)), *centre),
    }
}

fn isometry(pose: Pose, offset: [f64; 2]) -> Isometry {
    let [x, y] = pose.transform(offset);
    Isometry::new(Vector::new(x, y), pose.theta)
}

fn parry_distance(a: (&Part, Pose), b: (&Part, Pose)) -> f64 {
    let ((shape_a, at_a), (shape_b, at_b)) = (parry(a.0), parry(b.0));
    contact(
        &isometry(a.1, at_a),
        &*shape_a,
        &isometry(b.1, at_b),
        &*shape_b,
        1.0,
    )
    .expect("a supported pair")
    .expect("within a metre")
    .dist
}

fn single(part: &Part) -> Shape {
    shape(vec![part.clone()])
}

/// Poses from touching to overlapping: a random direction, at a distance that grows or shrinks with
/// `share` of the two sizes.
fn random_pair(random: &mut Random, a: &Shape, b: &Shape) -> [Pose; 2] {
    let share = random.range(0.0, 1.1);
    let (sin, cos) = libm::sincos(random.range(0.0, 7.0));
    let distance = share * (a.bounding_radius() + b.bounding_radius());
    let first = random.pose(0.2);
    [
        first,
        Pose::new(
            first.x + distance * cos,
            first.y + distance * sin,
            random.range(-7.0, 7.0),
        ),
    ]
}

/// The smallest gap is parry's signed distance, which is exact for these shapes (GJK apart,
/// SAT-like EPA in overlap) to rounding; and no contact is missed within a shorter search
/// distance.
fn compare(seed: u64, pairs: usize, part: impl Fn(&mut Random) -> [Part; 2]) {
    let mut random = Random(seed);
    let (mut apart, mut overlapping) = (0, 0);
    for _ in 0..pairs {
        let [a, b] = part(&mut random);
        let (object, other) = (single(&a), single(&b));
        let [p, q] = random_pair(&mut random, &object, &other);
        let expected = parry_distance((&a, p), (&b, q));
        let found = contacts((&object, p), (&other, q), 1.0);
        assert!(
            (smallest(&found) - expected).abs() < 1e-11,
            "{a:?} {p:?}\n{b:?} {q:?}\n{found:?}, not {expected}"
        );
        let distance = random.range(-0.002, 0.01);
        let near = contacts((&object, p), (&other, q), distance);
        assert_eq!(
            !near.is_empty(),
            smallest(&found) < distance,
            "{a:?} {p:?}\n{b:?} {q:?}\n{near:?}, distance {distance}"
        );
        if expected > 0.0 {
            apart += 1
        } else {
            overlapping += 1
        }
    }
    assert!(
        apart > pairs / 4 && overlapping > pairs / 4,
        "{apart} {overlapping}"
    );
}

fn random_disc(random: &mut Random) -> Part {
    disc(
        random.range(0.001, 0.03),
        [random.range(-0.02, 0.02), random.range(-0.02, 0.02)],
    )
}

#[test]
fn polygon_pairs_match_parry() {
    compare(1, 20_000, |r| [random_polygon(r), random_polygon(r)]);
}

#[test]
fn polygon_and_disc_match_parry() {
    compare(2, 20_000, |r| [random_polygon(r), random_disc(r)]);
    compare(3, 20_000, |r| [random_disc(r), random_polygon(r)]);
}

#[test]
fn polygons_of_many_corners_match_parry() {
    compare(5, 5_000, |r| [random_polygon_of_many(r), random_disc(r)]);
    compare(6, 5_000, |r| [random_disc(r), random_polygon_of_many(r)]);
    compare(7, 5_000, |r| [random_polygon_of_many(r), random_polygon(r)]);
    compare(8, 2_000, |r| {
        [random_polygon_of_many(r), random_polygon_of_many(r)]
    });
}

#[test]
fn disc_pairs_match_parry() {
    compare(4, 5_000, |r| [random_disc(r), random_disc(r)]);
}

#[test]
fn a_cross_of_two_bars_overlaps() {
    let bars = [
        rectangle([-0.03, 0.03], [-0.005, 0.005]),
        rectangle([-0.004, 0.004], [-0.03, 0.03]),
    ];
    let [a, b] = [single(&bars[0]), single(&bars[1])];
    let found = contacts(
        (&a, Pose::default()),
        (&b, Pose::new(0.001, 0.002, 0.1)),
        1e-3,
    );
    let expected = parry_distance(
        (&bars[0], Pose::default()),
        (&bars[1], Pose::new(0.001, 0.002, 0.1)),
    );
    assert!(
        found.len() == 1 && (found[0].gap - expected).abs() < 1e-12,
        "{found:?}, not {expected}"
    );
}
