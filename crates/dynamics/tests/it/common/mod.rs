//! Scenes and small tools that the tests of the dynamics share.
use stickslip_dynamics::{
    Dynamics, Feet, FingerMotion, Fixel, Friction, Lanes, Object, Part, Particle, Pose, Pusher,
    Report, Scene, Shape, StepInput, StepProblem, StepSolution, StepWork, Twist, Unknowns,
};

/// One camera frame [s].
pub const FRAME: f64 = 1.0 / 30.0;

/// SplitMix64; a test's random numbers are a function of its seed alone.
pub struct Rng(pub u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }
}

pub fn disc(radius: f64) -> Shape {
    Shape::new(vec![Part::Disc {
        radius,
        centre: [0.0, 0.0],
    }])
    .expect("a disc")
}

pub fn polygon(vertices: Vec<[f64; 2]>) -> Shape {
    Shape::new(vec![Part::Polygon { vertices }]).expect("a convex polygon")
}

/// The square of half side `half`.
pub fn square(half: f64) -> Shape {
    polygon(vec![
        [-half, -half],
        [half, -half],
        [half, half],
        [-half, half],
    ])
}

/// The regular polygon with `n` corners at distance `radius`, the first one in direction +x.
pub fn regular(n: u32, radius: f64) -> Shape {
    let corner = |k: u32| libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(n));
    polygon(
        (0..n)
            .map(corner)
            .map(|(sin, cos)| [radius * cos, radius * sin])
            .collect(),
    )
}

pub fn fixel(shape: Shape, x: f64, y: f64) -> Fixel {
    Fixel {
        pose: Pose::new(x, y, 0.0),
        shape,
    }
}

pub const FRICTION: Friction = Friction {
    mu_s: 0.3,
    mu_p: 0.3,
    mu_f: 0.3,
    d_tri: 0.02,
};

/// A 0.5 kg square of 50 mm with a rigid disc of 5 mm as its pusher: `bench-scene/scene.toml` with
/// other fixels.
pub fn square_scene(fixels: Vec<Fixel>) -> Scene {
    Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.083_333_333_333_333_5e-4,
            shape: square(0.025),
        },
        feet: Feet::Tripod {
            angle: std::f64::consts::FRAC_PI_2,
        },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: None,
        },
        fixels,
        nominal: FRICTION,
    }
}

/// The scene of `bench-scene/scene.toml`.
pub fn bench_scene() -> Scene {
    let places = [[0.0794, 0.0591], [0.1203, -0.0458], [0.0606, 0.0485]];
    square_scene(places.map(|[x, y]| fixel(disc(0.005), x, y)).to_vec())
}

/// The pusher at `x`, `y`, commanded to move along +x at `speed`.
pub fn pushing(h: f64, x: f64, y: f64, speed: f64) -> StepInput {
    let twist = Twist {
        vx: speed,
        ..Twist::default()
    };
    StepInput {
        h,
        pusher: Some(
            FingerMotion {
                pose: Pose::new(x, y, 0.0),
                twist,
                direction: [1.0, 0.0],
            }
            .into(),
        ),
    }
}

/// The input of frame `f` of `bench-scene`: 20 mm/s for 6.6 s, then at rest.
pub fn bench_input(f: u32) -> StepInput {
    let x = -0.032 + 0.020 * f64::from(f.min(198)) / 30.0;
    pushing(FRAME, x, -0.0033, if f < 198 { 0.020 } else { 0.0 })
}

pub fn at(pose: Pose) -> Particle {
    Particle {
        pose,
        ..Particle::default()
    }
}

/// One step of one particle with the scene's nominal friction.
pub fn step(
    dynamics: &Dynamics,
    input: &StepInput,
    particle: &mut Particle,
    work: &mut StepWork<1>,
) -> Report {
    let [report] = dynamics.step(
        input,
        &[dynamics.scene().nominal],
        std::array::from_mut(particle),
        work,
    );
    report
}

pub fn kinetic_energy(object: &Object, twist: &Twist) -> f64 {
    0.5 * object.mass * (twist.vx * twist.vx + twist.vy * twist.vy)
        + 0.5 * object.inertia * twist.omega * twist.omega
}

/// Distance of two twists [m/s], rotation at the radius of gyration.
pub fn twist_distance(problem: &StepProblem, a: Twist, b: Twist) -> f64 {
    let gyration = (problem.inertia / problem.mass).sqrt();
    (a.vx - b.vx)
        .abs()
        .max((a.vy - b.vy).abs())
        .max(gyration * (a.omega - b.omega).abs())
}

/// The fastest speed in a problem's data [m/s]: what errors are measured by.
pub fn fastest(problem: &StepProblem) -> f64 {
    let gyration = (problem.inertia / problem.mass).sqrt();
    let (v, p) = (problem.twist, problem.applied);
    let own = [
        v.vx,
        v.vy,
        gyration * v.omega,
        p.fx / problem.mass,
        p.fy / problem.mass,
        p.torque / (problem.mass * gyration),
    ];
    let others = problem.contacts.iter().flat_map(|c| {
        [
            (-c.gap / problem.h).max(0.0),
            c.surface_velocity[0],
            c.surface_velocity[1],
        ]
    });
    own.into_iter()
        .chain(others)
        .map(f64::abs)
        .fold(0.0, f64::max)
}

/// A solution in the solver's units, from the definitions: impulses over the mass, rotation at the
/// radius of gyration.
pub fn normalised(problem: &StepProblem, solution: &StepSolution) -> Unknowns<1> {
    let (m, gyration) = (problem.mass, (problem.inertia / problem.mass).sqrt());
    let over_mass = |p: &f64| Lanes([p / m]);
    let Twist { vx, vy, omega } = solution.twist;
    Unknowns {
        v: [Lanes([vx]), Lanes([vy]), Lanes([gyration * omega])],
        normal: solution.normal.iter().map(over_mass).collect(),
        tangential: solution.tangential.iter().map(over_mass).collect(),
        feet: solution.feet.map(|p| p.each_ref().map(over_mass)),
        pusher_yield: Lanes([solution.pusher_yield]),
    }
}
