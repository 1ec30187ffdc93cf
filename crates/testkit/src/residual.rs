//! The natural-map residual of one step, written from the model alone: [`residual_si`].
//!
//! A second route to the certificate of the solver. Everything stays in SI units (N s, and N m s
//! about the centre of mass by cross products). Only at the very end each row is divided by the
//! mass, the angular one by m ρ with ρ = sqrt(J/m), so that all rows are in m/s. Multiplying a
//! natural map by the mass first changes nothing: min(p, m g)/m = min(p/m, g).
//!
//! ```text
//! twist   m v⁺ − m v − Σ impulses − p_app,  (J ω⁺ − J ω − Σ torques − τ_app)/ρ
//! gap     min(p_n, m (n·(v_p − u + y d) + ψ/h))      v_p = v⁺ + ω⁺ ẑ × r, y d on pusher contacts only
//! slip    p_t − clamp(p_t − m (t·(v_p − u + y d) + c p_t), ±μ max(p_n, 0))
//! foot    |p_k − proj_{b_k}(p_k − m s_k)|
//! stall   min(F_stall h − F, m y); without a stall limit m y
//! ```

use stickslip_dynamics::{ContactPoint, StepProblem, StepSolution};

use crate::vector::{cross, dot, left};

/// Condition to which a residual belongs; the numbers index contacts and feet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualRow {
    /// Newton's law along x.
    ForceX,
    /// Newton's law along y.
    ForceY,
    /// Euler's law about the centre of mass.
    Torque,
    /// Complementarity of gap and normal impulse.
    Gap(usize),
    /// Coulomb friction of a contact.
    Slip(usize),
    /// Coulomb friction of a foot.
    Foot(usize),
    /// Complementarity of the drive's force reserve and yield.
    Stall,
}

/// Largest row of the natural map (m/s); zero exactly at solutions, infinite where any number of
/// problem or solution is not finite.
///
/// # Panics
/// Where the solution has not one normal and one tangential impulse per contact.
#[must_use]
pub fn residual_si(problem: &StepProblem, solution: &StepSolution) -> f64 {
    residual_rows_si(problem, solution)
        .into_iter()
        .map(|(_, value)| value)
        .fold(0.0, f64::max)
}

/// Every row of the natural map (m/s), absolute values; all infinite where any number of problem or
/// solution is not finite.
///
/// # Panics
/// Where the solution has not one normal and one tangential impulse per contact.
#[must_use]
pub fn residual_rows_si(problem: &StepProblem, solution: &StepSolution) -> Vec<(ResidualRow, f64)> {
    let contacts = problem.contacts.len();
    assert_eq!(
        solution.normal.len(),
        contacts,
        "one normal impulse per contact"
    );
    assert_eq!(
        solution.tangential.len(),
        contacts,
        "one tangential impulse per contact"
    );
    let mut rows = momentum_rows(problem, solution);
    for i in 0..contacts {
        rows.extend(contact_rows(problem, solution, i));
    }
    rows.extend((0..3).map(|k| (ResidualRow::Foot(k), foot_row(problem, solution, k))));
    rows.push((ResidualRow::Stall, stall_row(problem, solution)));
    let finite = numbers(problem, solution).into_iter().all(f64::is_finite);
    let in_speed = |impulse: f64| {
        if finite {
            (impulse / problem.mass).abs()
        } else {
            f64::INFINITY
        }
    };
    rows.into_iter()
        .map(|(row, impulse)| (row, in_speed(impulse)))
        .collect()
}

/// Impulse of a contact on the object (N s).
fn contact_impulse(contact: &ContactPoint, normal: f64, tangential: f64) -> [f64; 2] {
    let (n, t) = (contact.normal, left(contact.normal));
    [
        normal * n[0] + tangential * t[0],
        normal * n[1] + tangential * t[1],
    ]
}

/// All impulses on the object with their arms.
fn impulses(problem: &StepProblem, solution: &StepSolution) -> Vec<([f64; 2], [f64; 2])> {
    let magnitudes = solution.normal.iter().zip(&solution.tangential);
    let contacts = problem
        .contacts
        .iter()
        .zip(magnitudes)
        .map(|(c, (&n, &t))| (c.arm, contact_impulse(c, n, t)));
    let feet = problem
        .feet
        .iter()
        .zip(solution.feet)
        .map(|(foot, p)| (foot.arm, p));
    contacts.chain(feet).collect()
}

fn momentum_rows(problem: &StepProblem, solution: &StepSolution) -> Vec<(ResidualRow, f64)> {
    let (mass, inertia) = (problem.mass, problem.inertia);
    let (before, after, applied) = (problem.twist, solution.twist, problem.applied);
    let mut x = mass * after.vx - mass * before.vx - applied.fx;
    let mut y = mass * after.vy - mass * before.vy - applied.fy;
    let mut torque = inertia * after.omega - inertia * before.omega - applied.torque;
    for (arm, p) in impulses(problem, solution) {
        x -= p[0];
        y -= p[1];
        torque -= cross(arm, p);
    }
    let gyration = (inertia / mass).sqrt();
    vec![
        (ResidualRow::ForceX, x),
        (ResidualRow::ForceY, y),
        (ResidualRow::Torque, torque / gyration),
    ]
}

/// Velocity of the object's contact point relative to the other body's surface (m/s).
fn relative_velocity(
    problem: &StepProblem,
    solution: &StepSolution,
    contact: &ContactPoint,
) -> [f64; 2] {
    let (v, u) = (solution.twist.at(contact.arm), contact.surface_velocity);
    let pusher_yield = match (problem.stall, contact.yields) {
        (Some(_), Some(direction)) => direction.map(|d| solution.pusher_yield * d),
        _ => [0.0; 2],
    };
    [
        v[0] - (u[0] - pusher_yield[0]),
        v[1] - (u[1] - pusher_yield[1]),
    ]
}

fn contact_rows(
    problem: &StepProblem,
    solution: &StepSolution,
    i: usize,
) -> [(ResidualRow, f64); 2] {
    let contact = &problem.contacts[i];
    let (normal, tangential) = (solution.normal[i], solution.tangential[i]);
    let relative = relative_velocity(problem, solution, contact);
    let gap_speed = dot(contact.normal, relative) + contact.gap / problem.h;
    let slip = dot(left(contact.normal), relative);
    let limit = contact.mu * normal.max(0.0);
    let gap_row = normal.min(problem.mass * gap_speed);
    let slip_row = tangential - (tangential - problem.mass * slip).min(limit).max(-limit);
    [
        (ResidualRow::Gap(i), gap_row),
        (ResidualRow::Slip(i), slip_row),
    ]
}

fn foot_row(problem: &StepProblem, solution: &StepSolution, k: usize) -> f64 {
    let (foot, p) = (&problem.feet[k], solution.feet[k]);
    let slip = solution.twist.at(foot.arm);
    let target = [p[0] - problem.mass * slip[0], p[1] - problem.mass * slip[1]];
    let length = libm::hypot(target[0], target[1]);
    let scale = if length > foot.bound {
        foot.bound / length
    } else {
        1.0
    };
    libm::hypot(p[0] - scale * target[0], p[1] - scale * target[1])
}

fn stall_row(problem: &StepProblem, solution: &StepSolution) -> f64 {
    let lag = problem.mass * solution.pusher_yield;
    problem.stall.map_or(lag, |impulse| {
        lag.min(impulse - drive_impulse(problem, solution))
    })
}

/// F: the impulse with which the object resists the pusher (N s), along each finger's direction.
fn drive_impulse(problem: &StepProblem, solution: &StepSolution) -> f64 {
    let magnitudes = solution.normal.iter().zip(&solution.tangential);
    let contacts = problem.contacts.iter().zip(magnitudes);
    let along = contacts.filter_map(|(c, (&n, &t))| Some(dot(contact_impulse(c, n, t), c.yields?)));
    along.sum()
}

/// Everything that enters the rows: one number that is not finite makes all of them infinite.
fn numbers(problem: &StepProblem, solution: &StepSolution) -> Vec<f64> {
    let (v, w, p) = (problem.twist, solution.twist, problem.applied);
    let mut all = vec![
        problem.mass,
        problem.inertia,
        problem.h,
        solution.pusher_yield,
    ];
    all.extend([
        v.vx, v.vy, v.omega, w.vx, w.vy, w.omega, p.fx, p.fy, p.torque,
    ]);
    for c in &problem.contacts {
        all.extend([
            c.normal[0],
            c.normal[1],
            c.arm[0],
            c.arm[1],
            c.gap,
            c.mu,
            c.surface_velocity[0],
            c.surface_velocity[1],
        ]);
    }
    all.extend(solution.normal.iter().chain(&solution.tangential));
    all.extend(
        problem
            .feet
            .iter()
            .flat_map(|foot| [foot.arm[0], foot.arm[1], foot.bound]),
    );
    all.extend(solution.feet.as_flattened());
    if let Some(impulse) = problem.stall {
        let directions = problem.contacts.iter().filter_map(|contact| contact.yields);
        all.push(impulse);
        all.extend(directions.flatten());
    }
    all
}
