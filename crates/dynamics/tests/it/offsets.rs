//! A pusher and fixels with offsets from their poses act as a pusher and fixels at other poses.

use stickslip_dynamics::{
    Body, Dynamics, Feet, FingerMotion, Fixel, Friction, Lanes, Level, Object, Offsets, Part,
    Particle, Particles, Pose, Pusher, Scene, Shape, StepInput, StepWork, Support, Twist,
};

const FRICTION: Friction = Friction {
    mu_s: 0.28,
    mu_p: 0.3,
    mu_f: 0.25,
    d_tri: 0.02,
};

/// A square, pushed by a disc against two discs; `shift` moves these (m).
fn scene(shift: [[f64; 2]; 2]) -> Scene {
    scene_of_discs(shift, 0.005)
}

/// A scene like [`scene`] with discs of another radius (m).
fn scene_of_discs(shift: [[f64; 2]; 2], radius: f64) -> Scene {
    let disc = |radius| {
        let centre = [0.0, 0.0];
        Shape::new(vec![Part::Disc { radius, centre }]).expect("a disc")
    };
    let vertices = vec![
        [-0.025, -0.025],
        [0.025, -0.025],
        [0.025, 0.025],
        [-0.025, 0.025],
    ];
    let places = [[0.033, 0.015], [0.033, -0.015]];
    let fixel = |([x, y], [dx, dy]): ([f64; 2], [f64; 2])| Fixel {
        pose: Pose::new(x + dx, y + dy, 0.0),
        shape: disc(radius),
    };
    Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.1e-4,
            shape: Shape::new(vec![Part::Polygon { vertices }]).expect("a square"),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![disc(radius)],
            stall_force: Some(20.0),
        },
        fixels: places.into_iter().zip(shift).map(fixel).collect(),
        nominal: FRICTION,
    }
}

fn push(step: usize, [dx, dy]: [f64; 2]) -> StepInput {
    let x = -0.0302 + 0.0007 * step as f64;
    StepInput {
        h: 1.0 / 30.0,
        pusher: Some(
            FingerMotion {
                pose: Pose::new(x + dx, 0.004 + dy, 0.0),
                twist: Twist {
                    vx: 0.021,
                    ..Twist::default()
                },
                direction: [1.0, 0.0],
            }
            .into(),
        ),
    }
}

#[test]
fn each_lane_steps_as_in_a_scene_of_its_own() {
    for level in [Level::new(), Level::baseline()] {
        lanes_step_as_alone(level);
    }
}

fn lanes_step_as_alone(level: Level) {
    const LANES: usize = 8;
    let lane = |i: usize, k: usize| 1e-4 * ((7 * i + 3 * k) % 5) as f64 - 2e-4;
    let pusher = |i: usize| [lane(i, 0), lane(i, 1)];
    let fixels = |i: usize| [[lane(i, 2), lane(i, 3)], [lane(i, 4), lane(i, 5)]];

    // all lanes at once, with offsets
    let dynamics = Dynamics::new(scene([[0.0; 2]; 2])).with_level(level);
    let mut chunk = Particles::<LANES>::default();
    (0..LANES).for_each(|i| chunk.set(i, &Particle::default(), &FRICTION));
    let mut chunk = [chunk];
    let columns = |of: &dyn Fn(usize) -> [f64; 2]| {
        [0, 1].map(|axis| Lanes(std::array::from_fn(|i| of(i)[axis])))
    };
    let pushers = [columns(&pusher)];
    let places = [columns(&|i| fixels(i)[0]), columns(&|i| fixels(i)[1])];
    let mut work = StepWork::default();

    // each lane alone, where everything stands at its own pose
    let mut alone: Vec<Particle> = vec![Particle::default(); LANES];
    let mut own_work = StepWork::<1>::default();
    for step in 0..30 {
        let offsets = Offsets {
            pusher: &pushers,
            pusher_turn: &[],
            fixels: &places,
            supports: &[],
        };
        dynamics.step_block_offset(&push(step, [0.0; 2]), offsets, &mut chunk, &mut work);
        for (i, particle) in alone.iter_mut().enumerate() {
            let mut one = [*particle];
            Dynamics::new(scene(fixels(i))).step(
                &push(step, pusher(i)),
                &[FRICTION],
                &mut one,
                &mut own_work,
            );
            *particle = one[0];
            assert_eq!(chunk[0].get(i).pose, particle.pose, "lane {i}, step {step}");
            assert_eq!(work.reports()[0][i], own_work.reports()[0][0]);
            for body in [Body::Finger(0), Body::Fixel(0), Body::Fixel(1)] {
                let (of_lane, own) = (told(&work, body).map(|x| x[i]), told(&own_work, body));
                assert_eq!(
                    of_lane,
                    own.map(|x| x[0]),
                    "{body:?}, lane {i}, step {step}"
                );
            }
            assert_eq!(work.solution(i), own_work.solution(0));
            assert_eq!(work.problem(i).contacts.len(), work.bodies(i).len());
        }
    }
    let moved: Vec<f64> = alone.iter().map(|particle| particle.pose.x).collect();
    assert!(moved.iter().all(|x| *x > 1e-3), "{moved:?}");
    assert!(moved.windows(2).any(|pair| pair[0] != pair[1]), "{moved:?}");
}

/// Impulse, gap and slip of a body in a step, lane by lane.
fn told<const W: usize>(work: &StepWork<W>, body: Body) -> [[f64; W]; 3] {
    [
        work.normal_impulses(0, body).0,
        work.gaps(0, body).0,
        work.slips(0, body).0,
    ]
}

/// A bar that is turned from its pose acts as one with a turned pose.
#[test]
fn a_turned_pusher_is_one_whose_pose_is_turned() {
    const LANES: usize = 8;
    let turn = |i: usize| 5e-3 * (i as f64 - 3.5);
    let mut scene = scene([[0.0; 2]; 2]);
    let corners = vec![
        [-0.004, -0.02],
        [0.004, -0.02],
        [0.004, 0.02],
        [-0.004, 0.02],
    ];
    scene.pusher.fingers[0] = Shape::new(vec![Part::Polygon { vertices: corners }]).expect("a bar");
    let dynamics = Dynamics::new(scene);
    let mut chunk = [Particles::<LANES>::default()];
    (0..LANES).for_each(|i| chunk[0].set(i, &Particle::default(), &FRICTION));
    let turns = [Lanes(std::array::from_fn(turn))];
    let mut alone: Vec<Particle> = vec![Particle::default(); LANES];
    let (mut work, mut own_work) = (StepWork::default(), StepWork::<1>::default());
    for step in 0..30 {
        let offsets = Offsets {
            pusher: &[[Lanes::ZERO; 2]],
            pusher_turn: &turns,
            fixels: &[[Lanes::ZERO; 2]; 2],
            supports: &[],
        };
        dynamics.step_block_offset(&push(step, [0.0; 2]), offsets, &mut chunk, &mut work);
        for (i, particle) in alone.iter_mut().enumerate() {
            let mut turned = push(step, [0.0; 2]);
            let pusher = turned.pusher.as_mut().expect("a pusher");
            pusher[0].pose.theta += turn(i);
            let mut one = [*particle];
            dynamics.step(&turned, &[FRICTION], &mut one, &mut own_work);
            [*particle] = one;
            let (found, expected) = (chunk[0].get(i).pose, particle.pose);
            let apart = (found.x - expected.x).abs() + (found.y - expected.y).abs();
            assert!(
                apart + 0.02 * (found.theta - expected.theta).abs() < 1e-9,
                "lane {i}, step {step}: {found:?}, {expected:?}"
            );
        }
    }
    let turned: Vec<f64> = alone.iter().map(|particle| particle.pose.theta).collect();
    assert!(
        turned
            .windows(2)
            .any(|pair| (pair[0] - pair[1]).abs() > 1e-3),
        "{turned:?}"
    );
}

#[test]
fn an_image_of_the_feet_is_known_feet_at_its_places() {
    for level in [Level::new(), Level::baseline()] {
        feet_stand_as_known(level, None);
        feet_stand_as_known(level, Some(Pose::new(-6e-3, 2e-3, 0.8)));
    }
}

/// Checks offsets from the scene's tripod (`None`), or from three known feet that stand as its
/// tripod in the frame `about`: these turn about their own centre.
fn feet_stand_as_known(level: Level, about: Option<Pose>) {
    const LANES: usize = 8;
    let image = |i: usize| Support {
        centre: [1e-3 * (i as f64 - 4.0), 2e-3 - 5e-4 * i as f64],
        map: [
            [1.0 + 0.05 * i as f64, -0.1],
            [0.1 * i as f64, 1.0 - 0.08 * i as f64],
        ],
    };
    let beside = about.map_or_else(
        || scene([[0.0; 2]; 2]),
        |about| on_known_feet(about, Support::default()),
    );
    let dynamics = Dynamics::new(beside).with_level(level);
    let about = about.unwrap_or_default();
    let mut chunk = [Particles::<LANES>::default()];
    (0..LANES).for_each(|i| chunk[0].set(i, &Particle::default(), &FRICTION));
    let column = |of: &dyn Fn(Support) -> f64| Lanes(std::array::from_fn(|i| of(image(i))));
    let images = [Support {
        centre: [0, 1].map(|k| column(&|image| image.centre[k])),
        map: [0, 1].map(|k| [0, 1].map(|l| column(&|image| image.map[k][l]))),
    }];
    let mut work = StepWork::default();
    let mut alone: Vec<Particle> = vec![Particle::default(); LANES];
    let mut own_work = StepWork::<1>::default();
    for step in 0..30 {
        let offsets = Offsets {
            pusher: &[[Lanes::ZERO; 2]],
            pusher_turn: &[],
            fixels: &[[Lanes::ZERO; 2]; 2],
            supports: &images,
        };
        dynamics.step_block_offset(&push(step, [0.0; 2]), offsets, &mut chunk, &mut work);
        for (i, particle) in alone.iter_mut().enumerate() {
            let mut one = [*particle];
            Dynamics::new(on_known_feet(about, image(i))).step(
                &push(step, [0.0; 2]),
                &[FRICTION],
                &mut one,
                &mut own_work,
            );
            *particle = one[0];
            let (found, expected) = (chunk[0].get(i).pose, particle.pose);
            let apart = (found.x - expected.x).hypot(found.y - expected.y);
            assert!(
                apart + 0.02 * (found.theta - expected.theta).abs() < 1e-9,
                "lane {i}, step {step}: {found:?}, {expected:?}"
            );
        }
    }
    let turned: Vec<f64> = alone.iter().map(|particle| particle.pose.theta).collect();
    let apart = turned.windows(2).map(|pair| (pair[0] - pair[1]).abs());
    assert!(apart.fold(0.0, f64::max) > 1e-3, "{turned:?}");
}

/// The scene on three known feet: those of a tripod in the frame `about`, of which this is an
/// image.
fn on_known_feet(about: Pose, image: Support) -> Scene {
    let mut scene = scene([[0.0; 2]; 2]);
    let Feet::Tripod { angle } = scene.feet else {
        panic!("a tripod");
    };
    let positions = [0.0, 1.0, 2.0].map(|third: f64| {
        let direction = about.theta + angle + third * std::f64::consts::TAU / 3.0;
        let (sin, cos) = libm::sincos(direction);
        let place = |k: usize, centre: f64| {
            let [x, y] = image.map[k];
            centre + image.centre[k] + FRICTION.d_tri * (x * cos + y * sin)
        };
        [place(0, about.x), place(1, about.y)]
    });
    scene.feet = Feet::Known {
        positions,
        loads: [1.0 / 3.0; 3],
    };
    scene
}
