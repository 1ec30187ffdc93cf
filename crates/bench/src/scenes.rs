//! The timing scene of `bench-scene/scene.toml` and its variations.

use std::ops::Range;

use stickslip_dynamics::{
    Feet, FingerMotion, Fixel, Friction, Object, Part, Particle, Pose, Pusher, Scene, Shape,
    ShapeError, StepInput, Twist,
};
use stickslip_filter::{Purpose, Streams};

/// One camera frame (s).
pub const FRAME: f64 = 1.0 / 30.0;

/// Frames of the timing scene.
pub const FRAMES: u32 = 600;

/// Frames in which its pusher moves.
pub const MOVING: Range<usize> = 0..198;

/// Its phases, by name, with the frames over which each is timed.
pub const PHASES: [(&str, Range<usize>); 4] = [
    ("pushed", 10..76),
    ("one fixel", 95..146),
    ("two fixels", 165..198),
    ("rest", 300..600),
];

/// Speed of its pusher (m/s).
const SPEED: f64 = 0.020;

/// Largest shift of a particle's start on each axis (m) and its largest turn (rad).
const SCATTER: [f64; 3] = [3e-4, 3e-4, 0.5 * std::f64::consts::PI / 180.0];

/// A pushed object of 0.5 kg, the pusher and the fixels given, in the timing scene's places.
#[must_use]
pub fn pushed_object(object: Shape, pusher: Shape, fixels: Vec<Fixel>) -> Scene {
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

/// The timing scene: a square of 50 mm, a disc as its pusher, three fixels.
///
/// # Errors
/// None: the shapes are valid.
pub fn timing_scene() -> Result<Scene, ShapeError> {
    let a = 0.025;
    let square = Shape::new(vec![Part::Polygon {
        vertices: vec![[-a, -a], [a, -a], [a, a], [-a, a]],
    }])?;
    let disc = Shape::new(vec![Part::Disc {
        radius: 0.005,
        centre: [0.0; 2],
    }])?;
    let places = [[0.0794, 0.0591], [0.1203, -0.0458], [0.0606, 0.0485]];
    let fixels = places.map(|[x, y]| Fixel {
        pose: Pose::new(x, y, 0.0),
        shape: disc.clone(),
    });
    Ok(pushed_object(square, disc.clone(), fixels.to_vec()))
}

/// Input of the timing scene in one frame: 20 mm/s for 6.6 s, then rest.
#[must_use]
pub fn timing_input(frame: u32) -> StepInput {
    let stop = MOVING.end as u32;
    let pose = Pose::new(
        -0.032 + SPEED * f64::from(frame.min(stop)) * FRAME,
        -0.0033,
        0.0,
    );
    let twist = Twist {
        vx: if frame < stop { SPEED } else { 0.0 },
        ..Twist::default()
    };
    StepInput {
        h: FRAME,
        pusher: Some(
            FingerMotion {
                pose,
                twist,
                direction: [1.0, 0.0],
            }
            .into(),
        ),
    }
}

/// Particle `index` at the start of the timing scene: the first at the origin, the others up to 0.3
/// mm and 0.5° off it.
#[must_use]
pub fn scattered(index: u32) -> Particle {
    let draw = Streams::new(0).of(Purpose::Initialise).at(0);
    let within = |axis: u32| {
        if index == 0 {
            0.0
        } else {
            SCATTER[axis as usize] * (2.0 * draw.uniform(index, axis) - 1.0)
        }
    };
    Particle {
        pose: Pose::new(within(0), within(1), within(2)),
        ..Particle::default()
    }
}
