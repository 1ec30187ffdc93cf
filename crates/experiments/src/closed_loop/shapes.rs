//! Random shapes of objects, pushers and fixels (m), in their own frames.

use std::f64::consts::{PI, TAU};

use stickslip_dynamics::{Part, Shape};

use super::mass_properties::MassProperties;
use stickslip_testkit::SplitMix64;

/// Shortest and longest radius of an object (m).
const OBJECT_RADIUS: [f64; 2] = [10e-3, 60e-3];

/// An object's shape about its centroid, with the square of its radius of gyration (m²).
#[derive(Clone, Debug)]
pub(super) struct ObjectShape {
    pub shape: Shape,
    pub gyration_squared: f64,
}

/// Any object: polygons regular, irregular and thin, unions, discs and ellipses.
pub(super) fn object(rng: &mut SplitMix64) -> ObjectShape {
    let radius = rng.log_within(OBJECT_RADIUS[0], OBJECT_RADIUS[1]);
    let parts = match rng.below(8) {
        0 => vec![disc(radius)],
        1 => vec![ellipse(rng, radius)],
        2 => ell(rng, radius),
        3 => lollipop(rng, radius),
        _ => vec![polygon_part(rng, radius)],
    };
    about_centroid(&parts)
}

/// An object that is one convex polygon.
pub(super) fn polygonal_object(rng: &mut SplitMix64) -> ObjectShape {
    let radius = rng.log_within(OBJECT_RADIUS[0], OBJECT_RADIUS[1]);
    about_centroid(&[polygon_part(rng, radius)])
}

/// Any pusher: disc, bar, wedge or small polygon; bars and wedges face +x.
pub(super) fn pusher(rng: &mut SplitMix64) -> Shape {
    match rng.below(4) {
        0 => made(vec![disc(rng.log_within(2e-3, 15e-3))]),
        1 => bar(rng),
        2 => wedge(rng),
        _ => small_polygon(rng),
    }
}

/// A bar across x.
pub(super) fn bar(rng: &mut SplitMix64) -> Shape {
    rectangle(rng.within(4e-3, 10e-3), rng.within(20e-3, 100e-3))
}

/// A triangle whose tip points along +x.
pub(super) fn wedge(rng: &mut SplitMix64) -> Shape {
    let (length, half) = (rng.within(5e-3, 20e-3), rng.within(2e-3, 15e-3));
    polygon(vec![[length, 0.0], [0.0, half], [0.0, -half]])
}

/// Any fixel: disc, polygon or rectangle.
pub(super) fn fixel(rng: &mut SplitMix64) -> Shape {
    match rng.below(3) {
        0 => made(vec![disc(rng.log_within(2e-3, 15e-3))]),
        1 => small_polygon(rng),
        _ => rectangle(rng.log_within(4e-3, 40e-3), rng.log_within(4e-3, 40e-3)),
    }
}

/// A rectangle about the origin, its sides along x and y (m).
pub(super) fn rectangle(along_x: f64, along_y: f64) -> Shape {
    polygon(corners([0.0; 2], [along_x / 2.0, along_y / 2.0]))
}

/// A disc about the origin.
pub(super) fn round(radius: f64) -> Shape {
    made(vec![disc(radius)])
}

/// A regular polygon of 3 to 6 corners, the first one along +x.
pub(super) fn small_polygon(rng: &mut SplitMix64) -> Shape {
    let (corners, radius) = (3 + rng.below(4), rng.log_within(3e-3, 15e-3));
    polygon(regular(corners, radius))
}

fn made(parts: Vec<Part>) -> Shape {
    Shape::new(parts).expect("parts that make a shape")
}

fn polygon(vertices: Vec<[f64; 2]>) -> Shape {
    made(vec![Part::Polygon { vertices }])
}

fn disc(radius: f64) -> Part {
    let centre = [0.0; 2];
    Part::Disc { radius, centre }
}

fn ellipse(rng: &mut SplitMix64, radius: f64) -> Part {
    let semi_axes = [radius, radius * rng.within(0.3, 0.95)];
    Part::ellipse(semi_axes, [0.0; 2], rng.within(-PI, PI))
}

fn polygon_part(rng: &mut SplitMix64, radius: f64) -> Part {
    let vertices = match rng.below(4) {
        0 => regular(3 + rng.below(6), radius),
        1 => irregular(rng, radius),
        2 => corners([0.0; 2], [radius, radius * rng.log_within(0.05, 0.3)]),
        _ => corners([0.0; 2], [radius, radius * rng.within(0.3, 1.0)]),
    };
    Part::Polygon { vertices }
}

/// An L of two rectangles that share an edge in part.
fn ell(rng: &mut SplitMix64, radius: f64) -> Vec<Part> {
    let (width, foot) = (radius * rng.within(0.3, 0.8), radius * rng.within(0.3, 0.8));
    let upright = corners([0.0, radius], [width / 2.0, radius]);
    let lying = corners([width / 2.0 + foot, width / 2.0], [foot, width / 2.0]);
    [upright, lying]
        .map(|vertices| Part::Polygon { vertices })
        .into()
}

/// A disc with a bar through it.
fn lollipop(rng: &mut SplitMix64, radius: f64) -> Vec<Part> {
    let half_width = radius * rng.within(0.1, 0.4);
    let vertices = corners([radius * 1.2, 0.0], [radius * 1.2, half_width]);
    vec![
        disc(radius * rng.within(0.6, 1.0)),
        Part::Polygon { vertices },
    ]
}

fn corners([x, y]: [f64; 2], [a, b]: [f64; 2]) -> Vec<[f64; 2]> {
    vec![
        [x - a, y - b],
        [x + a, y - b],
        [x + a, y + b],
        [x - a, y + b],
    ]
}

fn on_circle(radius: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    [radius * cos, radius * sin]
}

fn regular(corners: usize, radius: f64) -> Vec<[f64; 2]> {
    let angle = |k: usize| TAU * k as f64 / corners as f64;
    (0..corners).map(|k| on_circle(radius, angle(k))).collect()
}

/// Corners of a circle, squeezed along y.
fn irregular(rng: &mut SplitMix64, radius: f64) -> Vec<[f64; 2]> {
    let (corners, squeeze) = (3 + rng.below(4), rng.within(0.4, 1.0));
    let angle = |k: usize, jitter: f64| TAU * (k as f64 + jitter) / corners as f64;
    (0..corners)
        .map(|k| on_circle(radius, angle(k, rng.within(-0.35, 0.35))))
        .map(|[x, y]| [x, squeeze * y])
        .collect()
}

fn about_centroid(parts: &[Part]) -> ObjectShape {
    let [x, y] = MassProperties::of(parts).centroid();
    let moved = |[px, py]: &[f64; 2]| [px - x, py - y];
    let parts: Vec<Part> = parts
        .iter()
        .map(|part| match part {
            Part::Polygon { vertices } => Part::Polygon {
                vertices: vertices.iter().map(moved).collect(),
            },
            Part::Disc { radius, centre } => Part::Disc {
                radius: *radius,
                centre: moved(centre),
            },
        })
        .collect();
    ObjectShape {
        gyration_squared: MassProperties::of(&parts).gyration_squared(),
        shape: made(parts),
    }
}
