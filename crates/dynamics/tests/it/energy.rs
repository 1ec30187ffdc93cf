//! Kinetic energy without a pusher: it never rises, but for what overlap gives back.
//!
//! With v⁺ − v = M⁻¹ W p and friction that opposes slip, one step changes the energy by at most Σ
//! v⁺·W_n p_n = −Σ p_n ψ/h.

use crate::common::{
    FRICTION, Rng, at, disc, fixel, kinetic_energy, pushing, regular, square, step,
};
use stickslip_dynamics::{
    Dynamics, Feet, Friction, Object, Outcome, Part, Particle, Pose, Pusher, Scene, Shape,
    StepInput, StepWork, TOLERANCE, Twist,
};
use stickslip_testkit::{gap_margin, may_jam};

const RUNS: u32 = 60;
const STEPS: u32 = 300;
const H: f64 = 0.004;

fn any_shape(rng: &mut Rng, size: f64) -> Shape {
    match rng.below(5) {
        0 => disc(size),
        1 => square(0.7 * size),
        2 => regular(3, size),
        3 => regular(5, size),
        _ => {
            let bar = |x: f64, y: f64| vec![[-x, -y], [x, -y], [x, y], [-x, y]];
            let parts = [bar(size, 0.3 * size), bar(0.3 * size, size)];
            Shape::new(parts.map(|vertices| Part::Polygon { vertices }).to_vec()).expect("a cross")
        }
    }
}

/// An object in a ring of fixels, on a slippery support, next to a pusher at rest.
fn arena(rng: &mut Rng) -> Dynamics {
    let place = |k: u32, rng: &mut Rng| {
        let (sin, cos) = libm::sincos(f64::from(k) * 0.7 + rng.within(-0.1, 0.1));
        let mut f = fixel(any_shape(rng, 0.012), 0.09 * cos, 0.09 * sin);
        f.pose.theta = rng.within(-3.0, 3.0);
        f
    };
    let fixels = (0..9).map(|k| place(k, rng)).collect();
    let friction = Friction {
        mu_s: rng.within(0.0, 0.05),
        mu_f: rng.within(0.0, 0.8),
        mu_p: rng.within(0.0, 0.8),
        ..FRICTION
    };
    Dynamics::new(Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.3,
            inertia: 1e-4,
            shape: any_shape(rng, 0.03),
        },
        feet: Feet::Tripod {
            angle: rng.within(0.0, 2.0),
        },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: (rng.below(2) == 0).then_some(2.0),
        },
        fixels,
        nominal: friction,
    })
}

fn thrown(rng: &mut Rng) -> Particle {
    let twist = Twist {
        vx: rng.within(-1.5, 1.5),
        vy: rng.within(-1.5, 1.5),
        omega: rng.within(-30.0, 30.0),
    };
    Particle {
        twist,
        ..at(Pose::new(0.0, 0.0, rng.within(-3.0, 3.0)))
    }
}

/// Counts over all runs.
#[derive(Debug, Default)]
struct Count {
    touching: u32,
    overlapping: u32,
    infeasible: u32,
}

fn check_step(
    dynamics: &Dynamics,
    input: &StepInput,
    particle: &mut Particle,
    work: &mut StepWork<1>,
    count: &mut Count,
) {
    let object = &dynamics.scene().object;
    let before = kinetic_energy(object, &particle.twist);
    let report = step(dynamics, input, particle, work);
    let after = kinetic_energy(object, &particle.twist);
    assert!(after.is_finite());
    if report.outcome != Outcome::Solved {
        // Between fixels that it overlaps, it is held from two sides.
        assert_eq!(report.outcome, Outcome::Infeasible);
        assert!(
            may_jam(&work.problem(0)) || gap_margin(&work.problem(0), 1.0) < 0.0,
            "{:?}",
            work.problem(0)
        );
        count.infeasible += 1;
        return;
    }
    let (problem, solution) = (work.problem(0), work.solution(0));
    let returned: f64 = problem
        .contacts
        .iter()
        .zip(&solution.normal)
        .map(|(c, p)| p * (-c.gap / problem.h).max(0.0))
        .sum();
    // A residual of TOLERANCE counts on the velocity of every impulse.
    let impulses: f64 = solution
        .normal
        .iter()
        .chain(solution.feet.as_flattened())
        .map(|p| p.abs())
        .sum();
    let slack = 4.0 * TOLERANCE * (impulses + object.mass * libm::sqrt(2.0 * before / object.mass));
    assert!(
        after <= before + returned + slack,
        "{before:e} J rises to {after:e} J, overlap returns {returned:e} J"
    );
    count.touching += u32::from(solution.normal.iter().any(|&p| p > 0.0));
    // what rests in contact overlaps by rounding
    count.overlapping += u32::from(returned > slack);
}

#[test]
fn step_with_the_pusher_at_rest_never_adds_kinetic_energy() {
    let (mut rng, mut count) = (Rng(1), Count::default());
    for _ in 0..RUNS {
        let dynamics = arena(&mut rng);
        let (mut particle, mut work) = (thrown(&mut rng), StepWork::default());
        let input = pushing(H, 0.055, 0.05, 0.0);
        for _ in 0..STEPS {
            check_step(&dynamics, &input, &mut particle, &mut work, &mut count);
        }
    }
    // Both halves of the claim were put to the test.
    assert!(
        count.touching > 2000
            && count.overlapping > 200
            && count.touching - count.overlapping > 800,
        "{count:?}"
    );
    assert!(count.infeasible * 100 < RUNS * STEPS, "{count:?}");
}
