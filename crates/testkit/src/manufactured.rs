//! Problems made from their solution: [`manufactured`] draws the motion after the step and every
//! impulse, then computes the load.
//!
//! A solver that fails on one of these has failed; "there may be no solution" is no excuse.

use stickslip_dynamics::{ContactPoint, StepProblem, StepSolution, Twist, Wrench};

use crate::problem_builder::{FASTEST, Other, ProblemBuilder};
use crate::vector::{cross, dot, left};

/// The motion after the step.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    Rest,
    Pivot(usize),
    WithPusher,
    Any,
}

/// A problem with `contacts` contacts and a solution of it; the builder's load is overwritten.
pub(crate) fn manufactured(
    mut builder: ProblemBuilder,
    motion: Motion,
    contacts: usize,
) -> (StepProblem, StepSolution) {
    // Gaps are h times the approach; speeds are kept so low that they stay within 2 mm.
    let fastest = FASTEST.min(5e-4 / builder.problem.h);
    slow_down(&mut builder, fastest);
    let twist = after(&mut builder, motion, fastest);
    let mut solution = StepSolution {
        twist,
        ..StepSolution::default()
    };
    if builder.rng.one_in(3) {
        solution.pusher_yield =
            builder.rng.within(0.0, 1.0) * libm::hypot(builder.pusher.vx, builder.pusher.vy);
    }
    for _ in 0..contacts {
        add_contact(&mut builder, &mut solution);
    }
    for k in 0..3 {
        solution.feet[k] = foot_impulse(&mut builder, twist, k);
    }
    set_stall(&mut builder, &mut solution);
    builder.problem.applied = missing_load(&builder.problem, &solution);
    (builder.problem, solution)
}

fn slow_down(builder: &mut ProblemBuilder, fastest: f64) {
    let speed = builder.rng.log_within(fastest * 1e-3, fastest);
    let drive = builder.drive();
    builder.pusher = Twist {
        vx: speed * drive[0],
        vy: speed * drive[1],
        omega: 0.0,
    };
}

fn after(builder: &mut ProblemBuilder, motion: Motion, fastest: f64) -> Twist {
    let twist = builder.twist_between(fastest * 1e-3, fastest);
    match motion {
        Motion::Rest => Twist::default(),
        Motion::WithPusher => builder.pusher,
        Motion::Any => twist,
        Motion::Pivot(k) => {
            let [x, y] = builder.problem.feet[k].arm;
            Twist {
                vx: twist.omega * y,
                vy: -twist.omega * x,
                omega: twist.omega,
            }
        }
    }
}

/// A closed or open contact whose gap follows from the motion.
fn add_contact(builder: &mut ProblemBuilder, solution: &mut StepSolution) {
    let other = if builder.rng.one_in(2) {
        Other::Pusher
    } else {
        Other::Fixel
    };
    let normal = builder.rng.direction();
    let mut contact = builder.contact_anywhere(other, normal);
    let relative = relative_velocity(builder, solution, &contact);
    let opens = builder.rng.one_in(3);
    let gap_speed = if opens {
        builder.rng.within(0.0, 0.05)
    } else {
        0.0
    };
    contact.gap = builder.problem.h * (gap_speed - dot(contact.normal, relative));
    let size = (builder.bound + builder.problem.mass * 0.1) * builder.rng.within(0.0, 1.0);
    let normal = if opens { 0.0 } else { size };
    solution.normal.push(normal);
    solution.tangential.push(friction(
        builder,
        &contact,
        normal,
        dot(left(contact.normal), relative),
    ));
    builder.add(contact);
}

fn relative_velocity(
    builder: &ProblemBuilder,
    solution: &StepSolution,
    contact: &ContactPoint,
) -> [f64; 2] {
    let (v, u, d) = (
        solution.twist.at(contact.arm),
        contact.surface_velocity,
        builder.drive(),
    );
    let pusher_yield = if contact.yields.is_some() {
        solution.pusher_yield
    } else {
        0.0
    };
    [
        v[0] - (u[0] - pusher_yield * d[0]),
        v[1] - (u[1] - pusher_yield * d[1]),
    ]
}

fn friction(builder: &mut ProblemBuilder, contact: &ContactPoint, normal: f64, slip: f64) -> f64 {
    let share = if slip == 0.0 {
        builder.rng.within(-1.0, 1.0)
    } else {
        -slip.signum()
    };
    share * contact.mu * normal
}

fn foot_impulse(builder: &mut ProblemBuilder, twist: Twist, k: usize) -> [f64; 2] {
    let foot = builder.problem.feet[k];
    let slip = twist.at(foot.arm);
    let length = libm::hypot(slip[0], slip[1]);
    if length > 0.0 {
        return slip.map(|s| -foot.bound * s / length);
    }
    let (size, e) = (
        foot.bound * builder.rng.unit().sqrt(),
        builder.rng.direction(),
    );
    e.map(|e| size * e)
}

/// Sets the drive's stall impulse so that the drawn yield solves the drive's condition. Where the
/// object does not resist the pusher there can be no yield: it becomes commanded motion.
fn set_stall(builder: &mut ProblemBuilder, solution: &mut StepSolution) {
    let direction = builder.drive();
    let resisting = builder
        .problem
        .contacts
        .iter()
        .zip(solution.normal.iter().zip(&solution.tangential))
        .filter(|(c, _)| c.yields.is_some());
    let force: f64 = resisting
        .map(|(c, (n, t))| n * dot(c.normal, direction) + t * dot(left(c.normal), direction))
        .sum();
    if solution.pusher_yield > 0.0 {
        // a drive with a negative limit would pull back
        if force <= 0.0 {
            let pusher_yield = solution.pusher_yield;
            solution.pusher_yield = 0.0;
            let contacts = builder.problem.contacts.iter_mut();
            for contact in contacts.filter(|c| c.yields.is_some()) {
                contact.surface_velocity = [0, 1]
                    .map(|axis| contact.surface_velocity[axis] - pusher_yield * direction[axis]);
            }
            return;
        }
        builder.problem.stall = Some(force);
    } else if builder.rng.one_in(3) {
        let reserve = builder.rng.within(0.1, 2.0) * builder.bound;
        builder.problem.stall = Some(force.max(0.0) + reserve);
    }
}

/// The applied impulse that closes Newton's and Euler's laws.
fn missing_load(problem: &StepProblem, solution: &StepSolution) -> Wrench {
    let (after, before) = (solution.twist, problem.twist);
    let mut load = Wrench {
        fx: problem.mass * (after.vx - before.vx),
        fy: problem.mass * (after.vy - before.vy),
        torque: problem.inertia * (after.omega - before.omega),
    };
    let mut subtract = |arm: [f64; 2], p: [f64; 2]| {
        load.fx -= p[0];
        load.fy -= p[1];
        load.torque -= cross(arm, p);
    };
    for (c, (normal, tangential)) in problem
        .contacts
        .iter()
        .zip(solution.normal.iter().zip(&solution.tangential))
    {
        let t = left(c.normal);
        subtract(
            c.arm,
            [
                normal * c.normal[0] + tangential * t[0],
                normal * c.normal[1] + tangential * t[1],
            ],
        );
    }
    problem
        .feet
        .iter()
        .zip(solution.feet)
        .for_each(|(foot, p)| subtract(foot.arm, p));
    load
}
