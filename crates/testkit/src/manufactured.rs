//! Problems made from their solution: [`manufactured`] draws the motion after the step and every
//! impulse, then computes the load.
//!
//! A solver that fails on one of these has failed; "there may be no solution" is no excuse.

use stickslip_dynamics::{ContactPoint, Stall, StepProblem, StepSolution, Twist, Wrench};

use crate::draft::{Body, Draft, FASTEST};
use crate::residual::{cross, dot, left};

/// The motion after the step.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    Rest,
    Pivot(usize),
    WithPusher,
    Any,
}

/// A problem with `contacts` contacts and a solution of it; overwrites the draft's load.
pub(crate) fn manufactured(
    mut draft: Draft,
    motion: Motion,
    contacts: usize,
) -> (StepProblem, StepSolution) {
    // Gaps are h times the approach; speeds are kept so low that they stay within 2 mm.
    let fastest = FASTEST.min(5e-4 / draft.problem.h);
    slow_down(&mut draft, fastest);
    let twist = after(&mut draft, motion, fastest);
    let mut solution = StepSolution {
        twist,
        ..StepSolution::default()
    };
    if draft.rng.one_in(3) {
        solution.pusher_yield =
            draft.rng.within(0.0, 1.0) * libm::hypot(draft.pusher.vx, draft.pusher.vy);
    }
    for _ in 0..contacts {
        add_contact(&mut draft, &mut solution);
    }
    for k in 0..3 {
        solution.feet[k] = foot_impulse(&mut draft, twist, k);
    }
    settle_drive(&mut draft, &mut solution);
    draft.problem.applied = missing_load(&draft.problem, &solution);
    (draft.problem, solution)
}

fn slow_down(draft: &mut Draft, fastest: f64) {
    let speed = draft.rng.log_within(fastest * 1e-3, fastest);
    let drive = draft.drive();
    draft.pusher = Twist {
        vx: speed * drive[0],
        vy: speed * drive[1],
        omega: 0.0,
    };
}

fn after(draft: &mut Draft, motion: Motion, fastest: f64) -> Twist {
    let twist = draft.twist_between(fastest * 1e-3, fastest);
    match motion {
        Motion::Rest => Twist::default(),
        Motion::WithPusher => draft.pusher,
        Motion::Any => twist,
        Motion::Pivot(k) => {
            let [x, y] = draft.problem.feet[k].arm;
            Twist {
                vx: twist.omega * y,
                vy: -twist.omega * x,
                omega: twist.omega,
            }
        }
    }
}

/// A closed or open contact whose gap is what the motion asks for.
fn add_contact(draft: &mut Draft, solution: &mut StepSolution) {
    let body = if draft.rng.one_in(2) {
        Body::Pusher
    } else {
        Body::Fixel
    };
    let normal = draft.rng.direction();
    let mut contact = draft.contact_anywhere(body, normal);
    let relative = relative_velocity(draft, solution, &contact);
    let opens = draft.rng.one_in(3);
    let gap_speed = if opens {
        draft.rng.within(0.0, 0.05)
    } else {
        0.0
    };
    contact.gap = draft.problem.h * (gap_speed - dot(contact.normal, relative));
    let size = (draft.bound + draft.problem.mass * 0.1) * draft.rng.within(0.0, 1.0);
    let normal = if opens { 0.0 } else { size };
    solution.normal.push(normal);
    solution.tangential.push(friction(
        draft,
        &contact,
        normal,
        dot(left(contact.normal), relative),
    ));
    draft.add(contact);
}

fn relative_velocity(draft: &Draft, solution: &StepSolution, contact: &ContactPoint) -> [f64; 2] {
    let (v, u, d) = (
        solution.twist.at(contact.arm),
        contact.surface_velocity,
        draft.drive(),
    );
    let lost = if contact.on_pusher {
        solution.pusher_yield
    } else {
        0.0
    };
    [v[0] - (u[0] - lost * d[0]), v[1] - (u[1] - lost * d[1])]
}

fn friction(draft: &mut Draft, contact: &ContactPoint, normal: f64, slip: f64) -> f64 {
    let share = if slip == 0.0 {
        draft.rng.within(-1.0, 1.0)
    } else {
        -slip.signum()
    };
    share * contact.mu * normal
}

fn foot_impulse(draft: &mut Draft, twist: Twist, k: usize) -> [f64; 2] {
    let foot = draft.problem.feet[k];
    let slip = twist.at(foot.arm);
    let length = libm::hypot(slip[0], slip[1]);
    if length > 0.0 {
        return slip.map(|s| -foot.bound * s / length);
    }
    let (size, e) = (foot.bound * draft.rng.unit().sqrt(), draft.rng.direction());
    e.map(|e| size * e)
}

/// Gives the drive the limit that the yield asks for; where the object does not resist it cannot
/// yield, and the gaps are redone.
fn settle_drive(draft: &mut Draft, solution: &mut StepSolution) {
    let direction = draft.drive();
    let resisting = draft
        .problem
        .contacts
        .iter()
        .zip(solution.normal.iter().zip(&solution.tangential))
        .filter(|(c, _)| c.on_pusher);
    let force: f64 = resisting
        .map(|(c, (n, t))| n * dot(c.normal, direction) + t * dot(left(c.normal), direction))
        .sum();
    if solution.pusher_yield > 0.0 {
        // A negative limit would be a drive that pulls back: turn the contacts' yield into
        // commanded motion instead.
        if force <= 0.0 {
            let lost = solution.pusher_yield;
            solution.pusher_yield = 0.0;
            for contact in draft.problem.contacts.iter_mut().filter(|c| c.on_pusher) {
                contact.surface_velocity =
                    [0, 1].map(|axis| contact.surface_velocity[axis] - lost * direction[axis]);
            }
            return;
        }
        draft.problem.stall = Some(Stall {
            impulse: force,
            direction,
        });
    } else if draft.rng.one_in(3) {
        let reserve = draft.rng.within(0.1, 2.0) * draft.bound;
        draft.problem.stall = Some(Stall {
            impulse: force.max(0.0) + reserve,
            direction,
        });
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
    let mut take = |arm: [f64; 2], p: [f64; 2]| {
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
        take(
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
        .for_each(|(foot, p)| take(foot.arm, p));
    load
}
