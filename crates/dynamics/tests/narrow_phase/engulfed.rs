//! Deep overlap: a large disc or ellipse that holds a whole part of a union.

use parry2d_f64::math::{Pose as Isometry, Vector};
use parry2d_f64::query::contact;
use parry2d_f64::shape::{ConvexPolygon, Shape as ParryShape};
use stickslip_dynamics::{Part, Pose, Shape};

use crate::shapes::{Random, contacts, disc, ellipse, polygon, rectangle, shape, smallest};

/// Corners of the polygon that stands for an oval.
const CORNERS: usize = 720;

/// An L of two bars, a small one at the end of a large one, and a notched block of triangles.
fn unions() -> Vec<Shape> {
    let small = |x: f64| rectangle([x, x + 0.012], [-0.006, 0.006]);
    vec![
        shape(vec![rectangle([-0.02, 0.04], [-0.02, -0.01]), rectangle([-0.02, -0.01], [-0.01, 0.04])]),
        shape(vec![rectangle([-0.03, 0.0], [-0.03, 0.03]), small(0.0)]),
        shape(vec![small(0.0), small(0.012), small(0.024)]),
        shape(vec![polygon(&[[-0.03, -0.02], [0.0, -0.02], [0.0, 0.005]]), polygon(&[[0.0, -0.02], [0.03, -0.02], [0.0, 0.005]])]),
    ]
}

fn ovals() -> Vec<(Shape, [f64; 2])> {
    let oval = |axes: [f64; 2]| (shape(vec![ellipse(axes, [0.0; 2], 0.0)]), axes);
    let round = |radius: f64| (shape(vec![disc(radius, [0.0; 2])]), [radius; 2]);
    vec![round(0.02), round(0.05), oval([0.03, 0.02]), oval([0.06, 0.012]), oval([0.05, 0.04]), oval([0.012, 0.004])]
}

fn inscribed([a, b]: [f64; 2]) -> ConvexPolygon {
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / CORNERS as f64);
        Vector::new(a * cos, b * sin)
    };
    ConvexPolygon::from_convex_polyline((0..CORNERS).map(corner).collect()).expect("a convex polygon")
}

/// Parry's signed distances of the oval to the parts.
fn distances(parts: &[Box<dyn ParryShape>], oval: &ConvexPolygon, pose: Pose) -> Vec<f64> {
    let at = Isometry::new(Vector::new(pose.x, pose.y), pose.theta);
    let distance = |part: &dyn ParryShape| contact(&Isometry::identity(), part, &at, oval, 1.0).expect("a supported pair");
    parts.iter().map(|part| distance(&**part).expect("within a metre").dist).collect()
}

fn parry(shape: &Shape) -> Vec<Box<dyn ParryShape>> {
    let convex = |part: &Part| -> Box<dyn ParryShape> {
        let Part::Polygon { vertices } = part else { unreachable!() };
        let points = vertices.iter().map(|v| Vector::new(v[0], v[1])).collect();
        Box::new(ConvexPolygon::from_convex_polyline(points).expect("a convex polygon"))
    };
    shape.parts().iter().map(convex).collect()
}

/// Wherever an oval overlaps a union there is a contact that says so. Where there is but one, it is a way out: the oval, moved
/// along it by the gap, has left a part that it overlapped.
#[test]
fn an_oval_about_a_part_touches_the_union() {
    let mut random = Random(11);
    let (mut overlapping, mut alone) = (0, 0);
    for union in unions() {
        let parts = parry(&union);
        for (oval, axes) in ovals() {
            let hull = inscribed(axes);
            for _ in 0..600 {
                let pose = random.pose(0.05);
                let before = distances(&parts, &hull, pose);
                if before.iter().all(|distance| *distance > -1e-4) {
                    continue;
                }
                overlapping += 1;
                let (here, there) = ((&union, Pose::default()), (&oval, pose));
                let found = contacts(here, there, 1e-3);
                assert!(smallest(&found) < 0.0 && smallest(&contacts(there, here, 1e-3)) < 0.0, "{axes:?} {pose:?}: {found:?}");
                if let [only] = found[..] {
                    alone += 1;
                    let [nx, ny] = only.normal;
                    let out = Pose::new(pose.x + only.gap * nx, pose.y + only.gap * ny, pose.theta);
                    let after = distances(&parts, &hull, out);
                    let left = before.iter().zip(&after).any(|(before, after)| *before < -1e-4 && *after > -1e-9);
                    assert!(left, "{axes:?} {pose:?}: {only:?}\n{before:?}\n{after:?}");
                }
            }
        }
    }
    assert!(overlapping > 3000 && alone > 500, "{overlapping} {alone}");
}
