//! The rig against closed forms: sliding block, spinning disc, bounces, pushing, sticking.

use stickslip_dynamics::{
    Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape, SpeedProfile, Start, Twist,
};

use super::Rig;
use super::contact::ContactLaw;
use super::drive::{DriveSettings, Spindle};
use super::pressure::PressureDistribution;
use super::state::RigState;
use super::support_friction::Bristles;
use super::table_friction::TableFriction;
use crate::trial::Trial;

const GRAVITY: f64 = 9.81;
const MASS: f64 = 0.4;
const RADIUS: f64 = 0.03;
const SPEED: f64 = 0.02;

fn disc(radius: f64) -> Shape {
    Shape::new(vec![Part::Disc {
        radius,
        centre: [0.0; 2],
    }])
    .expect("a disc")
}

/// A disc of 30 mm, a bar of 20 mm that stands to its left, and fixels.
fn scene(fixels: Vec<Fixel>) -> Scene {
    let bar = vec![[-0.005, -0.01], [0.0, -0.01], [0.0, 0.01], [-0.005, 0.01]];
    Scene {
        gravity: GRAVITY,
        object: Object {
            mass: MASS,
            inertia: 0.5 * MASS * RADIUS * RADIUS,
            shape: disc(RADIUS),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![Shape::new(vec![Part::Polygon { vertices: bar }]).expect("a bar")],
            stall_force: None,
        },
        fixels,
        nominal: Friction {
            mu_s: 0.25,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.02,
        },
    }
}

/// The object at the origin, the pusher touching it from the left or, at speed 0, far away.
fn start(speed: f64) -> Start {
    let x = if speed > 0.0 { -RADIUS } else { -1.0 };
    let pusher = Pose::new(x, 0.0, 0.0);
    Start {
        object: Pose::default(),
        pusher,
        direction: 0.0,
        other_fingers: Vec::new(),
        speed: SpeedProfile::constant(speed),
        duration: 1.0,
    }
}

/// A rig with uniform friction, even pressure and a rigid drive.
fn plain(scene: &Scene) -> Rig {
    let table = TableFriction {
        unevenness: 0.0,
        speed_effect: 0.0,
        ..TableFriction::default()
    };
    let drive = DriveSettings {
        lag: 0.0,
        ripple: 0.0,
        spindle: None,
    };
    Rig {
        table,
        drive,
        pressure: PressureDistribution::Face {
            points: 250,
            unevenness: 0.0,
        },
        longest_step: 2e-5,
        ..Rig::of(scene)
    }
}

/// Runs until `seconds` with the object thrown; the state at the end.
fn thrown<'a>(rig: &'a Rig, trial: &'a Trial<'a>, twist: Twist, seconds: f64) -> RigState<'a> {
    let mut state = RigState::new(rig, trial).expect("a rig");
    state.twist = twist;
    let h = state.longest_step();
    (0..(seconds / h).ceil() as u32).for_each(|step| state.step(h * f64::from(step), h));
    state
}

fn trial<'a>(scene: &'a Scene, start: &'a Start) -> Trial<'a> {
    Trial {
        scene,
        start,
        rate: 30.0,
        seed: 3,
    }
}

#[track_caller]
fn assert_near(value: f64, expected: f64, share: f64) {
    assert!(
        (value / expected - 1.0).abs() <= share,
        "{value} is not {expected} within {share}"
    );
}

#[test]
fn sliding_block_stops_where_friction_has_eaten_its_energy() {
    let (scene, start) = (scene(vec![]), start(0.0));
    let (rig, trial) = (plain(&scene), trial(&scene, &start));
    for speed in [0.1, 0.4] {
        let state = thrown(
            &rig,
            &trial,
            Twist {
                vx: 0.6 * speed,
                vy: -0.8 * speed,
                omega: 0.0,
            },
            0.5,
        );
        let travel = speed * speed / (2.0 * rig.mu_s * GRAVITY);
        // bristles take a few µm to stretch, and as many to let go
        assert!(
            (state.object.x - 0.6 * travel).abs() < 1e-5
                && (state.object.y + 0.8 * travel).abs() < 1e-5,
            "{:?}",
            state.object
        );
        assert!(
            state.object.theta.abs() < 1e-4 && state.twist.vx.abs() < 1e-6,
            "{:?} {:?}",
            state.object,
            state.twist
        );
    }
}

#[test]
fn sliding_block_on_friction_that_varies_with_speed_stops_where_the_quadrature_says() {
    let (scene, start) = (scene(vec![]), start(0.0));
    let table = TableFriction {
        unevenness: 0.0,
        speed_effect: -0.2,
        speed: 0.05,
        ..TableFriction::default()
    };
    let (rig, trial) = (
        Rig {
            table,
            ..plain(&scene)
        },
        trial(&scene, &start),
    );
    let state = thrown(
        &rig,
        &trial,
        Twist {
            vx: 0.3,
            ..Twist::default()
        },
        0.5,
    );
    // travel = ∫ v dv / (μ g φ(v)), φ(v) = 1 − 0.2 (v² − 0.05²) / (v² + 0.05²), by the midpoint rule
    let slow =
        |v: f64| v / (rig.mu_s * GRAVITY * (1.0 - 0.2 * (v * v - 2.5e-3) / (v * v + 2.5e-3)));
    let travel: f64 = (0..3000)
        .map(|k| 1e-4 * slow(1e-4 * (f64::from(k) + 0.5)))
        .sum();
    assert!(
        (state.object.x - travel).abs() < 1e-5,
        "{} {travel}",
        state.object.x
    );
}

#[test]
fn spinning_disc_under_even_pressure_stops_after_the_closed_form_s_angle() {
    let (scene, start) = (scene(vec![]), start(0.0));
    let pressure = PressureDistribution::Face {
        points: 2000,
        unevenness: 0.0,
    };
    let (rig, trial) = (
        Rig {
            pressure,
            ..plain(&scene)
        },
        trial(&scene, &start),
    );
    let state = thrown(
        &rig,
        &trial,
        Twist {
            omega: 12.0,
            ..Twist::default()
        },
        0.5,
    );
    // torque 2/3 μ m g R, J = m R²/2
    let slowing = 4.0 / 3.0 * rig.mu_s * GRAVITY / RADIUS;
    assert_near(state.object.theta, 0.5 * 12.0 * 12.0 / slowing, 3e-3);
    assert!(
        state.object.x.abs() < 1e-5 && state.twist.omega.abs() < 1e-4,
        "{:?} {:?}",
        state.object,
        state.twist
    );
    assert_near(state.tripod_radius(), 2.0 / 3.0 * RADIUS, 3e-3);
}

/// A fixel of 10 mm to the right of the object, 1 mm away along `angle`.
fn wall(angle: f64) -> Fixel {
    let (sin, cos) = libm::sincos(angle);
    Fixel {
        pose: Pose::new(0.041 * cos, 0.041 * sin, 0.0),
        shape: disc(0.01),
    }
}

#[test]
fn frictionless_bounce_without_damping_keeps_energy_and_mirrors_the_normal_speed() {
    for angle in [0.0, 0.3] {
        let (scene, start) = (scene(vec![wall(angle)]), start(0.0));
        // stiff, so that the normal does not turn while they touch
        let contact = ContactLaw {
            damping_ratio: 0.0,
            stiffness: 2e7,
            ..ContactLaw::default()
        };
        let rig = Rig {
            mu_s: 0.0,
            mu_f: 0.0,
            contact,
            longest_step: 1e-6,
            ..plain(&scene)
        };
        let trial = trial(&scene, &start);
        let state = thrown(
            &rig,
            &trial,
            Twist {
                vx: 0.1,
                vy: 0.0,
                omega: 2.0,
            },
            0.04,
        );
        let Twist { vx, vy, omega } = state.twist;
        // the disc meets the fixel where the line of flight says, not where the fixel stands
        let height = 0.041 * libm::sin(angle);
        let (sin, cos) = (height / 0.04, (1.0 - height * height / 1.6e-3).sqrt());
        let (normal, along) = (vx * cos + vy * sin, vy * cos - vx * sin);
        assert!(state.contacts.is_empty() && omega == 2.0, "still touching");
        assert_near((vx * vx + vy * vy).sqrt(), 0.1, 1e-4);
        assert_near(normal, -0.1 * cos, 2e-3);
        assert!((along + 0.1 * sin).abs() < 1e-4, "{along}");
    }
}

#[test]
fn damped_bounce_returns_the_speed_of_a_damped_spring_that_cannot_pull() {
    let (scene, start) = (scene(vec![wall(0.0)]), start(0.0));
    for zeta in [0.1, 0.5, 0.9] {
        let contact = ContactLaw {
            damping_ratio: zeta,
            ..ContactLaw::default()
        };
        let rig = Rig {
            mu_s: 0.0,
            mu_f: 0.0,
            contact,
            longest_step: 1e-6,
            ..plain(&scene)
        };
        let trial = trial(&scene, &start);
        let state = thrown(
            &rig,
            &trial,
            Twist {
                vx: 0.1,
                ..Twist::default()
            },
            0.03,
        );
        // x = v/ω_d exp(-ζωt) sin ω_d t; the force k x + c x' vanishes where tan ω_d t = -2 ζ
        // sqrt(1-ζ²) / (1-2ζ²)
        let root = (1.0 - zeta * zeta).sqrt();
        let phase = std::f64::consts::PI - libm::atan2(2.0 * zeta * root, 1.0 - 2.0 * zeta * zeta);
        let (sin, cos) = libm::sincos(phase);
        let restitution = -libm::exp(-zeta / root * phase) * (cos - zeta / root * sin);
        assert_near(state.twist.vx, -0.1 * restitution, 2e-3);
    }
}

#[test]
fn pushed_block_takes_the_force_of_its_friction_and_the_speed_of_the_pusher() {
    let (scene, start) = (scene(vec![]), start(SPEED));
    let rig = plain(&scene);
    let trace = rig.run(&trial(&scene, &start)).expect("a trace");
    let last = trace.frames.last().expect("frames");
    assert_near(last.pusher_force[0], rig.mu_s * MASS * GRAVITY, 1e-3);
    assert!(
        last.pusher_force[1].abs() < 1e-3 && (last.twist.vx - SPEED).abs() < 1e-6,
        "{last:?}"
    );
    assert_near(last.object.x, SPEED, 1e-3);
}

#[test]
fn jammed_object_stays_where_it_is_and_the_pusher_presses_with_its_stall_force() {
    // between a bar and two fixels, driven for 20 s
    let (scene, start) = (
        scene(vec![wall(0.5), wall(-0.5)]),
        Start {
            duration: 20.0,
            ..start(SPEED)
        },
    );
    let spindle = Spindle {
        stall_force: 15.0,
        ..Spindle::default()
    };
    let rig = Rig {
        drive: DriveSettings {
            spindle: Some(spindle),
            ..DriveSettings::default()
        },
        ..Rig::of(&scene)
    };
    let trace = rig.run(&trial(&scene, &start)).expect("a trace");
    let (early, last) = (&trace.frames[90], &trace.frames[600]);
    for (value, before) in [
        (last.object.x, early.object.x),
        (last.object.y, early.object.y),
        (last.pusher.x, early.pusher.x),
    ] {
        assert!((value - before).abs() < 1e-8, "{value} {before}");
    }
    // the table may carry a part of the stall force
    let weight = rig.mu_s * MASS * GRAVITY;
    assert!(
        (last.pusher_force[0] - 15.0).abs() < 0.01,
        "{:?}",
        last.pusher_force
    );
    let along: f64 = last.contacts[1..]
        .iter()
        .map(|contact| -contact.force[0])
        .sum();
    assert!(
        last.contacts.len() == 3 && (along - 15.0).abs() < 1.2 * weight,
        "{along}"
    );
}

#[test]
fn bristles_hold_below_their_limit_and_slip_above() {
    // a push of 80 % of the friction moves the object by what the bristles give, also where the
    // pusher's slide runs into it
    let scene = scene(vec![]);
    let limit = scene.nominal.mu_s * MASS * GRAVITY;
    for (share, moves) in [(0.8, false), (1.2, true)] {
        let spindle = Spindle {
            stall_force: share * limit,
            ..Spindle::default()
        };
        let drive = DriveSettings {
            lag: 0.0,
            ripple: 0.0,
            spindle: Some(spindle),
        };
        let (rig, start) = (
            Rig {
                drive,
                ..plain(&scene)
            },
            start(SPEED),
        );
        let trace = rig.run(&trial(&scene, &start)).expect("a trace");
        let travel = trace.frames.last().expect("frames").object.x;
        assert_eq!(travel > 0.01, moves, "{share}: {travel}");
        assert!(moves || travel < 3.0 * Bristles::default().give, "{travel}");
    }
}
