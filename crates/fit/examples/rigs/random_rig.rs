//! A random virtual rig with its pushes: [`RandomRig`].

use stickslip::Setup;
use stickslip_dynamics::{Feet, Pose, SpeedProfile, Start};
use stickslip_evaluation::{PUSHER_MEMORY, Physics, Simulation, SimulationOptions};
use stickslip_filter::Streams;
use stickslip_fit::{Parameter, Push};
use stickslip_formats::{TruthFacts, read_scene};

/// Distance of the pusher from the face at the start (m).
const CLEARANCE: f64 = 4e-3;

/// Largest angle between push and inward normal (rad).
const STEEPEST: f64 = 0.6;

/// Support of a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// The model's own tripod, moved by the model's own physics.
    Tripod,
    /// An image of it with the place, turn and stretch that the fit's prior draws.
    Prior,
    /// Its whole face, under uneven pressure.
    Face,
    /// Three feet anywhere, loaded as statics has it.
    ThreeFeet,
}

/// A rig, and the scene given to the fit.
#[derive(Clone, Debug)]
pub struct RandomRig {
    /// True values of the first of the parameters that are free by default: of all of a rig from
    /// the prior, else of μ_p and the tripod radius (m).
    pub truth: Vec<f64>,
    /// Pushes, with the scene given to the fit.
    pub pushes: Vec<Push>,
}

/// An outline about its centroid, and its second moment per area (m²).
struct Outline {
    vertices: Vec<[f64; 2]>,
    gyration_squared: f64,
}

impl RandomRig {
    /// The rig number `seed`, with `count` pushes, each against a random place of the outline.
    pub fn new(support: Support, seed: u64, count: usize) -> Self {
        let draw = Streams::new(seed).at(0);
        let outline = outline(draw.uniform(0, 0), draw.uniform(0, 1));
        let told = told(&outline, 2.5e-3 + 6e-3 * draw.uniform(0, 2));
        let [mu_s, mu_p, mu_f, d_tri] = draw.normals(1, 0);
        let friction = told.drawn_friction([mu_s, mu_p, mu_f, d_tri]);
        let mut truth = told.clone();
        truth.scene.nominal = friction;
        let mut values = vec![friction.mu_p, friction.d_tri];
        match support {
            Support::ThreeFeet => truth.scene.feet = three_feet(&told, seed),
            Support::Prior => {
                let free = Parameter::default_list(&told).into_iter();
                let drawn = |(k, free): (usize, Parameter)| match k {
                    0 | 1 => (free, values[k]),
                    _ => (free, free.prior(&told).value(draw.normal(4, k as u32))),
                };
                let drawn: Vec<(Parameter, f64)> = free.enumerate().map(drawn).collect();
                Parameter::apply(&drawn, &mut truth).expect("an outline");
                values = drawn.into_iter().map(|(_, value)| value).collect();
            }
            Support::Tripod | Support::Face => {}
        }

        // a pusher that starts in the object makes no push
        let mut trials = (0_u32..).filter_map(|k| {
            let start = start(&outline, &told, seed, k);
            let setup = Setup {
                start: Some(start),
                ..truth.clone()
            };
            let physics = match support {
                Support::Tripod | Support::Prior => Physics::Model,
                Support::Face | Support::ThreeFeet => Physics::Testbed,
            };
            let noise = if physics == Physics::Model {
                u64::from(k)
            } else {
                0
            };
            simulated(&setup, physics, 1000 * seed + noise)
        });
        let mut pushes = Vec::new();
        while pushes.len() < count {
            let (log, facts) = trials.next().expect("trials without an end");
            if support != Support::Prior {
                values[1] = facts.d_tri.expect("a rig has a radius");
            }
            pushes.push(Push {
                name: format!("push {}", pushes.len()),
                setup: told.clone(),
                log,
            });
        }
        if !matches!(support, Support::Tripod | Support::Prior) {
            // the first guess is off by as much as the scene says
            let guess = values[1] * libm::exp(-told.uncertainty.friction.d_tri * d_tri);
            pushes
                .iter_mut()
                .for_each(|push| push.setup.scene.nominal.d_tri = guess);
        }
        Self {
            truth: values,
            pushes,
        }
    }
}

fn simulated(setup: &Setup, physics: Physics, seed: u64) -> Option<(stickslip::Log, TruthFacts)> {
    let options = SimulationOptions {
        physics,
        seeds: seed.into(),
        rate: 30.0,
        repeats: 0.0,
        pusher_memory: PUSHER_MEMORY,
    };
    let simulation =
        Simulation::run(setup, &TruthFacts::default(), &options, &mut |_, _| ()).ok()?;
    let facts = simulation.facts.clone();
    Some((simulation.log, facts))
}

/// A regular polygon of 3 to 6 corners, a rectangle or a right triangle, 50 to 100 mm across.
fn outline(kind: f64, size: f64) -> Outline {
    let size = 0.025 + 0.025 * size;
    let kind = (6.0 * kind) as usize;
    let mut vertices: Vec<[f64; 2]> = match kind {
        0..=3 => (0..kind + 3)
            .map(|k| {
                let turn = std::f64::consts::TAU * k as f64 / (kind + 3) as f64;
                [size * libm::cos(turn), size * libm::sin(turn)]
            })
            .collect(),
        4 => vec![
            [-size, -0.5 * size],
            [size, -0.5 * size],
            [size, 0.5 * size],
            [-size, 0.5 * size],
        ],
        _ => vec![[0.0, 0.0], [2.0 * size, 0.0], [0.0, 1.3 * size]],
    };
    let [area, x, y, _] = moments(&vertices);
    let centre = [x / area, y / area];
    for vertex in &mut vertices {
        *vertex = [vertex[0] - centre[0], vertex[1] - centre[1]];
    }
    let [area, _, _, square] = moments(&vertices);
    Outline {
        vertices,
        gyration_squared: square / area,
    }
}

/// ∫ 1, x, y, x² + y² over a polygon.
fn moments(vertices: &[[f64; 2]]) -> [f64; 4] {
    let next = vertices.iter().cycle().skip(1);
    vertices
        .iter()
        .zip(next)
        .fold([0.0; 4], |sum, ([a, b], [c, d])| {
            let cross = a * d - b * c;
            let square = a * a + a * c + c * c + b * b + b * d + d * d;
            [
                sum[0] + cross / 2.0,
                sum[1] + cross * (a + c) / 6.0,
                sum[2] + cross * (b + d) / 6.0,
                sum[3] + cross * square / 12.0,
            ]
        })
}

/// The scene given to the fit.
fn told(outline: &Outline, pusher: f64) -> Setup {
    let corners: Vec<String> = outline
        .vertices
        .iter()
        .map(|[x, y]| format!("[{x:.6}, {y:.6}]"))
        .collect();
    let (corners, inertia) = (corners.join(", "), 0.5 * outline.gyration_squared);
    let radius = outline.gyration_squared.sqrt();
    let text = format!(
        "gravity = 9.81
        object  = {{ mass = 0.5, inertia = {inertia:.6e}, shape = [{{ polygon = [{corners}] }}] }}
        support = {{ friction = 0.3, tripod_radius = {radius:.6} }}
        pusher  = {{ friction = 0.3, stall_force = 100.0, shape = [{{ disc = {{ radius = {pusher:.6} }} }}] }}
        fixels  = {{ friction = 0.25 }}
        camera  = {{ position_std = 3.0e-4, orientation_std = 5.0e-3 }}"
    );
    read_scene(&text, "scene.toml").expect("a scene")
}

/// Feet about the centre of mass, none of which carries less than a tenth of the weight.
fn three_feet(told: &Setup, seed: u64) -> Feet {
    let radius = told.scene.object.gyration_radius();
    let turns = (1_u32..).find_map(|k| {
        let draw = Streams::new(seed).at(u64::from(k));
        let positions: [[f64; 2]; 3] = std::array::from_fn(|foot| {
            let turn = std::f64::consts::TAU * draw.uniform(2, foot as u32);
            let away = radius * (0.5 + 0.8 * draw.uniform(3, foot as u32));
            [away * libm::cos(turn), away * libm::sin(turn)]
        });
        let cross = |a: usize, b: usize| {
            positions[a][0] * positions[b][1] - positions[a][1] * positions[b][0]
        };
        let loads = [cross(1, 2), cross(2, 0), cross(0, 1)];
        let sum: f64 = loads.iter().sum();
        let loads = loads.map(|load| load / sum);
        loads
            .iter()
            .all(|load| *load > 0.1)
            .then_some(Feet::Known { positions, loads })
    });
    turns.expect("draws without an end")
}

/// A push against a random place of the outline.
fn start(outline: &Outline, told: &Setup, seed: u64, k: u32) -> Start {
    let draw = Streams::new(seed).at(1 << 30);
    let edges = outline.vertices.len();
    let edge = (edges as f64 * draw.uniform(k, 0)) as usize;
    let ([ax, ay], [bx, by]) = (outline.vertices[edge], outline.vertices[(edge + 1) % edges]);
    let share = 0.15 + 0.7 * draw.uniform(k, 1);
    let length = libm::hypot(bx - ax, by - ay);
    let inward = [-(by - ay) / length, (bx - ax) / length];
    let contact = [ax + share * (bx - ax), ay + share * (by - ay)];
    let direction = libm::atan2(inward[1], inward[0]) + STEEPEST * (2.0 * draw.uniform(k, 2) - 1.0);
    let radius = told.scene.pusher.fingers[0].bounding_radius();
    let back = CLEARANCE;
    let centre = [
        contact[0] - radius * inward[0] - back * libm::cos(direction),
        contact[1] - radius * inward[1] - back * libm::sin(direction),
    ];
    Start {
        object: Pose::default(),
        pusher: Pose::new(centre[0], centre[1], 0.0),
        direction,
        other_fingers: Vec::new(),
        speed: SpeedProfile::constant(0.015),
        duration: 1.5 + 1.5 * draw.uniform(k, 3),
    }
}
