//! The scene's position, its rotation and a mirror image do not change the results.

use crate::common::{
    FRAME, FRICTION, bench_input, bench_scene, disc, fixel, polygon, pushing, square_scene, step,
};
use stickslip_dynamics::{
    Dynamics, Feet, FingerMotion, Object, Outcome, Part, Particle, Pose, Scene, Shape, StepInput,
    StepWork, Twist, Wrench,
};

/// A turn by an angle, then a shift; or a mirror image, y for −y.
#[derive(Clone, Copy, Debug)]
enum Change {
    Move(Pose),
    Mirror,
}

use Change::{Mirror, Move};

const CHANGES: [Change; 6] = [
    Move(Pose {
        x: 1.0,
        y: -2.0,
        theta: 0.0,
    }),
    Move(Pose {
        x: 0.0,
        y: 0.0,
        theta: 0.1,
    }),
    Move(Pose {
        x: 0.0,
        y: 0.0,
        theta: std::f64::consts::FRAC_PI_2,
    }),
    Move(Pose {
        x: -0.3,
        y: 0.2,
        theta: 2.5,
    }),
    Move(Pose {
        x: 0.7,
        y: 0.4,
        theta: -30.0,
    }),
    Mirror,
];

impl Change {
    fn vector(self, v: [f64; 2]) -> [f64; 2] {
        match self {
            Move(by) => by.rotate(v),
            Mirror => [v[0], -v[1]],
        }
    }

    fn angle(self, theta: f64) -> f64 {
        match self {
            Move(by) => by.theta + theta,
            Mirror => -theta,
        }
    }

    /// The sign of turning.
    fn hand(self) -> f64 {
        match self {
            Move(_) => 1.0,
            Mirror => -1.0,
        }
    }

    fn pose(self, p: Pose) -> Pose {
        let [x, y] = match self {
            Move(by) => by.transform([p.x, p.y]),
            Mirror => [p.x, -p.y],
        };
        Pose::new(x, y, self.angle(p.theta))
    }

    fn twist(self, v: Twist) -> Twist {
        let [vx, vy] = self.vector([v.vx, v.vy]);
        Twist {
            vx,
            vy,
            omega: self.hand() * v.omega,
        }
    }

    fn wrench(self, w: Wrench) -> Wrench {
        let [fx, fy] = self.vector([w.fx, w.fy]);
        Wrench {
            fx,
            fy,
            torque: self.hand() * w.torque,
        }
    }

    fn motion(self, m: FingerMotion) -> FingerMotion {
        FingerMotion {
            pose: self.pose(m.pose),
            twist: self.twist(m.twist),
            direction: self.vector(m.direction),
        }
    }

    /// A shape in its own frame: only a mirror changes it.
    fn shape(self, shape: &Shape) -> Shape {
        let part = |part: &Part| match (self, part) {
            (Mirror, Part::Polygon { vertices }) => Part::Polygon {
                vertices: vertices.iter().rev().map(|v| self.vector(*v)).collect(),
            },
            (Mirror, Part::Disc { radius, centre }) => Part::Disc {
                radius: *radius,
                centre: self.vector(*centre),
            },
            (Move(_), part) => part.clone(),
        };
        Shape::new(shape.parts().iter().map(part).collect()).expect("a shape that was one before")
    }

    fn scene(self, scene: &Scene) -> Scene {
        let mut changed = scene.clone();
        changed.object.shape = self.shape(&scene.object.shape);
        changed.pusher.fingers[0] = self.shape(&scene.pusher.fingers[0]);
        for f in &mut changed.fixels {
            (f.pose, f.shape) = (self.pose(f.pose), self.shape(&f.shape));
        }
        if let (Mirror, Feet::Tripod { angle }) = (self, scene.feet) {
            changed.feet = Feet::Tripod { angle: -angle };
        }
        changed
    }
}

/// Poses of a run from `start`.
fn run(scene: Scene, start: Particle, inputs: &[StepInput]) -> Vec<Pose> {
    let (dynamics, mut particle, mut work) = (Dynamics::new(scene), start, StepWork::default());
    let one = |input| {
        let report = step(&dynamics, input, &mut particle, &mut work);
        assert_eq!(report.outcome, Outcome::Solved);
        particle.pose
    };
    inputs.iter().map(one).collect()
}

/// Runs the scene as it is and changed, and compares poses in the changed frame.
///
/// The solver aims at 1e-10 m/s, and the runs are stable: errors add up, they do not grow. Over 250
/// steps of 1/30 s that is 1e-9 m; where Newton's last step is quadratic, as here, 1e-12 is left.
fn assert_invariant(scene: &Scene, start: Particle, inputs: &[StepInput]) {
    let expected = run(scene.clone(), start, inputs);
    let [first, last] = [expected[0], expected[expected.len() - 1]];
    assert!(
        (last.x - first.x).abs() > 0.01 && (last.theta - first.theta).abs() > 0.1,
        "nothing happens: {last:?}"
    );
    for change in CHANGES {
        let start = Particle {
            pose: change.pose(start.pose),
            twist: change.twist(start.twist),
            applied: change.wrench(start.applied),
            ..Particle::default()
        };
        let inputs: Vec<_> = inputs
            .iter()
            .map(|i| StepInput {
                pusher: i.pusher.map(|pusher| pusher.map(|m| change.motion(m))),
                ..*i
            })
            .collect();
        let poses = run(change.scene(scene), start, &inputs);
        for (k, (pose, expected)) in poses.iter().zip(&expected).enumerate() {
            let e = change.pose(*expected);
            let error = [pose.x - e.x, pose.y - e.y, pose.theta - e.theta]
                .map(f64::abs)
                .into_iter()
                .fold(0.0, f64::max);
            assert!(error < 1e-9, "{change:?}, step {k}: off by {error:e}");
        }
    }
}

#[test]
fn push_past_fixels_is_invariant() {
    let inputs: Vec<_> = (0..250).map(bench_input).collect();
    assert_invariant(&bench_scene(), Particle::default(), &inputs);
}

#[test]
fn throw_of_a_spinning_triangle_against_fixels_is_invariant() {
    let mut scene = square_scene(vec![
        fixel(disc(0.01), 0.08, 0.01),
        fixel(disc(0.007), 0.03, -0.09),
    ]);
    scene.object = Object {
        mass: 0.2,
        inertia: 8e-5,
        shape: polygon(vec![[-0.02, -0.03], [0.04, 0.0], [-0.02, 0.03]]),
    };
    scene.nominal.mu_s = 0.1;
    let start = Particle {
        twist: Twist {
            vx: 0.6,
            vy: 0.1,
            omega: 6.0,
        },
        ..Particle::default()
    };
    assert_invariant(
        &scene,
        start,
        &vec![
            StepInput {
                h: 0.01,
                pusher: None
            };
            200
        ],
    );
}

#[test]
fn push_of_an_ell_by_a_turning_bar_under_load_is_invariant() {
    let mut scene = square_scene(vec![fixel(disc(0.006), 0.09, 0.033)]);
    let bar = |a: [f64; 2], b: [f64; 2]| Part::Polygon {
        vertices: vec![a, [b[0], a[1]], b, [a[0], b[1]]],
    };
    scene.object.shape = Shape::new(vec![
        bar([-0.03, -0.02], [0.03, 0.0]),
        bar([-0.03, 0.0], [-0.01, 0.03]),
    ])
    .expect("an ell");
    scene.pusher.fingers[0] = Shape::new(vec![bar([-0.004, -0.02], [0.004, 0.02])]).expect("a bar");
    scene.nominal = stickslip_dynamics::Friction {
        mu_p: 0.5,
        ..FRICTION
    };
    let load = Wrench {
        fx: 0.004,
        fy: -0.006,
        torque: 2e-4,
    };
    let input = |k: u32| {
        let mut input = pushing(FRAME, -0.04 + 0.02 * FRAME * f64::from(k), 0.002, 0.02);
        if let Some(pusher) = &mut input.pusher {
            pusher[0].pose.theta = 0.05 * FRAME * f64::from(k);
            pusher[0].twist.omega = 0.05;
        }
        input
    };
    assert_invariant(
        &scene,
        Particle {
            applied: load,
            ..Particle::default()
        },
        &(0..150).map(input).collect::<Vec<_>>(),
    );
}
