//! Shapes and scenes that tests share: [`pushed_scene`].

use stickslip_dynamics::{Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape};

/// A disc about the origin, its radius in m.
///
/// # Panics
/// If the radius is not positive.
#[must_use]
pub fn disc(radius: f64) -> Shape {
    let centre = [0.0; 2];
    Shape::new(vec![Part::Disc { radius, centre }]).expect("a disc")
}

/// A square about the origin, its edge in m.
///
/// # Panics
/// If the edge is not positive.
#[must_use]
pub fn square(edge: f64) -> Shape {
    let a = edge / 2.0;
    let vertices = vec![[-a, -a], [a, -a], [a, a], [-a, a]];
    Shape::new(vec![Part::Polygon { vertices }]).expect("a square")
}

/// Fixels of one shape at these positions (m).
#[must_use]
pub fn fixels(shape: &Shape, positions: &[[f64; 2]]) -> Vec<Fixel> {
    positions
        .iter()
        .map(|[x, y]| Fixel {
            pose: Pose::new(*x, *y, 0.0),
            shape: shape.clone(),
        })
        .collect()
}

/// An object of 0.5 kg on three feet, as heavy to turn as a square of 50 mm, friction 0.3
/// everywhere.
#[must_use]
pub fn pushed_scene(object: Shape, pusher: Shape, fixels: Vec<Fixel>) -> Scene {
    Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.083_333_333_333_333_5e-4,
            shape: object,
        },
        feet: Feet::Tripod {
            angle: std::f64::consts::FRAC_PI_2,
        },
        pusher: Pusher {
            fingers: vec![pusher],
            stall_force: None,
        },
        fixels,
        nominal: Friction {
            mu_s: 0.3,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.02,
        },
    }
}
