//! rapier2d on the timing scene, seen from above. The engine knows no support friction: before
//! every substep the three feet are brought to rest by hand, each within its friction disc, in a
//! few Gauss-Seidel sweeps. usage: peer-rapier SUBSTEPS; prints what compare.py reads.

use std::time::Instant;

use rapier2d_f64::prelude::*;

const MASS: f64 = 0.5;
const INERTIA: f64 = 2.083_333_333_333_333_5e-4;
const FRICTION: f64 = 0.3;
const SWEEPS: usize = 4;

struct Scene {
    world: PhysicsWorld,
    object: RigidBodyHandle,
    pusher: RigidBodyHandle,
    feet: [[f64; 2]; 3],
}

fn scene(h: f64, at: f64) -> Scene {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, 0.0);
    world.integration_parameters.dt = h;
    // lengths of the scene are centimetres: the engine's tolerances scale with this
    world.integration_parameters.length_unit = 0.01;
    let mass = MassProperties::new(Vector::new(0.0, 0.0), MASS, INERTIA);
    let body = RigidBodyBuilder::dynamic().translation(Vector::new(at, 0.0)).additional_mass_properties(mass).can_sleep(false);
    let (object, _) = world.insert(body, ColliderBuilder::cuboid(0.025, 0.025).density(0.0).friction(FRICTION));
    let disc = || ColliderBuilder::ball(0.005).friction(FRICTION);
    let thumb = RigidBodyBuilder::kinematic_velocity_based().translation(Vector::new(-0.032, -0.0033));
    let (pusher, _) = world.insert(thumb, disc());
    for [x, y] in [[0.0794, 0.0591], [0.1203, -0.0458], [0.0606, 0.0485]] {
        world.insert(RigidBodyBuilder::fixed().translation(Vector::new(x, y)), disc());
    }
    let feet = [0.0, 1.0, 2.0].map(|k: f64| {
        let angle = std::f64::consts::FRAC_PI_2 + k * std::f64::consts::TAU / 3.0;
        [0.02 * angle.cos(), 0.02 * angle.sin()]
    });
    Scene { world, object, pusher, feet }
}

impl Scene {
    fn step(&mut self, h: f64, speed: f64, force: f64) {
        self.world.bodies[self.pusher].set_linvel(Vector::new(speed, 0.0), true);
        self.brake(h, force);
        self.world.step();
    }

    fn brake(&mut self, h: f64, force: f64) {
        let body = &mut self.world.bodies[self.object];
        let (sin, cos) = body.rotation().angle().sin_cos();
        let mut v = [body.linvel().x + force * h / MASS, body.linvel().y, body.angvel()];
        let (mut impulses, limit) = ([[0.0; 2]; 3], FRICTION * MASS * 9.81 * h / 3.0);
        let arms = self.feet.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
        let effective = 1.0 / (1.0 / MASS + 4e-4 / INERTIA);
        for _ in 0..SWEEPS {
            for ([rx, ry], p) in arms.iter().zip(&mut impulses) {
                let slip = [v[0] - v[2] * ry, v[1] + v[2] * rx];
                let mut new = [p[0] - effective * slip[0], p[1] - effective * slip[1]];
                let size = new[0].hypot(new[1]);
                if size > limit {
                    new = [new[0] * limit / size, new[1] * limit / size];
                }
                let d = [new[0] - p[0], new[1] - p[1]];
                v = [v[0] + d[0] / MASS, v[1] + d[1] / MASS, v[2] + (rx * d[1] - ry * d[0]) / INERTIA];
                *p = new;
            }
        }
        body.set_linvel(Vector::new(v[0], v[1]), true);
        body.set_angvel(v[2], true);
    }
}

fn main() {
    let substeps: u32 = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(1);
    let h = 1.0 / 30.0 / f64::from(substeps);
    for round in 0..2 {
        let mut scene = scene(h, 0.0);
        for frame in 0..600 {
            let start = Instant::now();
            (0..substeps).for_each(|_| scene.step(h, if frame < 198 { 0.020 } else { 0.0 }, 0.0));
            let taken = start.elapsed().as_nanos();
            if round > 0 {
                let body = &scene.world.bodies[scene.object];
                let (p, angle) = (body.translation(), body.rotation().angle());
                println!("time {frame} {taken}\npose {frame} {:e} {:e} {angle:e}", p.x, p.y);
            }
        }
    }
    let mut scene = scene(h, 1.0);
    (0..150 * substeps).for_each(|_| scene.step(h, 0.0, 0.5 * FRICTION * MASS * 9.81));
    let p = scene.world.bodies[scene.object].translation();
    println!("creep {:e}", (p.x - 1.0).hypot(p.y) * 1e3);
}
