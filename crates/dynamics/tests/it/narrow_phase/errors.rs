//! Shapes that [`Shape::new`] refuses; the message says where, and what to do.

use stickslip_dynamics::{Part, Shape, ShapeError};

use super::shapes::{disc, polygon, rectangle};

/// The message for `part` as the second one of a shape.
fn refusal(part: Part) -> (ShapeError, String) {
    let error = Shape::new(vec![rectangle([-1.0, 1.0], [-1.0, 1.0]), part]).expect_err("no shape");
    let message = error.to_string();
    assert!(message.starts_with("part 2"), "{message}");
    (error, message)
}

#[test]
fn no_parts_are_no_shape() {
    assert_eq!(
        Shape::new(Vec::new()).expect_err("no shape"),
        ShapeError::Empty
    );
}

#[test]
fn radii_must_be_positive() {
    assert!(refusal(disc(0.0, [0.0; 2])).1.contains("the radius is 0 m"));
    assert!(
        refusal(disc(-0.5, [0.0; 2]))
            .1
            .contains("the radius is -0.5 m")
    );
}

#[test]
fn numbers_must_be_finite() {
    assert!(
        refusal(disc(f64::NAN, [0.0; 2]))
            .1
            .contains("the radius is NaN")
    );
    assert!(
        refusal(disc(1.0, [0.0, f64::INFINITY]))
            .1
            .contains("y of the centre is inf")
    );
    assert!(
        refusal(polygon(&[[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]))
            .1
            .contains("y of vertex 2 is NaN")
    );
}

#[test]
fn polygons_need_three_different_vertices() {
    assert!(
        refusal(polygon(&[[0.0, 0.0], [1.0, 0.0]]))
            .1
            .contains("2 vertices")
    );
    let closed = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    assert!(matches!(
        refusal(polygon(&closed)).0,
        ShapeError::RepeatedVertex { vertex: 1, .. }
    ));
    assert!(matches!(
        refusal(polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])).0,
        ShapeError::RepeatedVertex { vertex: 3, .. }
    ));
    assert!(matches!(
        refusal(polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])).0,
        ShapeError::Flat { .. }
    ));
}

#[test]
fn polygons_must_be_convex_and_counter_clockwise() {
    assert!(matches!(
        refusal(polygon(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]])).0,
        ShapeError::Clockwise { .. }
    ));
    let dart = polygon(&[[0.0, 0.0], [1.0, -1.0], [0.5, 0.0], [1.0, 1.0]]);
    assert!(matches!(
        refusal(dart).0,
        ShapeError::NotConvex { vertex: 3, .. }
    ));
    let spike = polygon(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert!(matches!(
        refusal(spike).0,
        ShapeError::NotConvex { vertex: 2, .. }
    ));
}

#[test]
fn a_star_crosses_itself() {
    let star: Vec<[f64; 2]> = (0..5)
        .map(|k| libm::sincos(f64::from(k) * 0.8 * std::f64::consts::PI))
        .map(|(s, c)| [c, s])
        .collect();
    assert!(matches!(
        refusal(polygon(&star)).0,
        ShapeError::SelfIntersecting { turns: 2, .. }
    ));
    let bow_tie = polygon(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    assert!(refusal(bow_tie).1.contains("crosses itself"));
}

#[test]
fn a_dent_of_rounding_is_forgiven() {
    let dented = polygon(&[
        [0.0, 0.0],
        [0.05, 1e-6],
        [0.1, 0.0],
        [0.1, 0.05],
        [0.0, 0.05],
    ]);
    assert!(Shape::new(vec![dented]).is_ok());
}
