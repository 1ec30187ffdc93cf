//! A step problem in mass-normalised units of order one: [`ScaledProblem`], the form in which the
//! numerical oracles solve it.
//!
//! Twists become z = (vx, vy, ρ ω)/S and impulses p/(m S), with ρ = sqrt(J/m) and S the largest
//! speed in the data. Then Newton's law reads z = z_free + Σ c p with columns c = (direction, arm ×
//! direction / ρ) and the velocity along a direction is c·z.

use stickslip_dynamics::{ContactPoint, StepProblem, Twist};

use crate::vector::{cross, dot, left};

/// Below this (m/s) a problem counts as at rest and is not scaled up.
const SLOWEST: f64 = 1e-6;

pub(crate) struct ScaledProblem<'a> {
    pub problem: &'a StepProblem,
    gyration: f64,
    speed: f64,
}

pub(crate) type Column = [f64; 3];

pub(crate) fn dot3(a: &Column, b: &Column) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<'a> ScaledProblem<'a> {
    pub fn new(problem: &'a StepProblem) -> Self {
        let unscaled = Self {
            problem,
            gyration: (problem.inertia / problem.mass).sqrt(),
            speed: 1.0,
        };
        let approach = |c: &ContactPoint| {
            (-c.gap / problem.h).max(libm::hypot(c.surface_velocity[0], c.surface_velocity[1]))
        };
        let fastest = problem
            .contacts
            .iter()
            .map(approach)
            .fold(SLOWEST, f64::max);
        let (free, before) = (unscaled.free(), unscaled.scale_twist(problem.twist));
        let speed = free
            .iter()
            .chain(&before)
            .map(|z| z.abs())
            .fold(fastest, f64::max);
        Self { speed, ..unscaled }
    }

    /// S (m/s).
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Impulse (N s) of one unit.
    pub fn impulse(&self) -> f64 {
        self.problem.mass * self.speed
    }

    pub fn column(&self, direction: [f64; 2], arm: [f64; 2]) -> Column {
        [
            direction[0],
            direction[1],
            cross(arm, direction) / self.gyration,
        ]
    }

    pub fn normal(&self, contact: &ContactPoint) -> Column {
        self.column(contact.normal, contact.arm)
    }

    pub fn tangent(&self, contact: &ContactPoint) -> Column {
        self.column(left(contact.normal), contact.arm)
    }

    /// The two rows of J_k, which are the columns of J_kᵀ too.
    pub fn foot(&self, k: usize) -> [Column; 2] {
        let arm = self.problem.feet[k].arm;
        [self.column([1.0, 0.0], arm), self.column([0.0, 1.0], arm)]
    }

    pub fn bound(&self, k: usize) -> f64 {
        self.problem.feet[k].bound / self.impulse()
    }

    /// Gap velocity at z = 0, y = 0: ψ/h − n·u.
    pub fn gap_offset(&self, contact: &ContactPoint) -> f64 {
        (contact.gap / self.problem.h - dot(contact.normal, contact.surface_velocity)) / self.speed
    }

    /// Slip velocity at z = 0, y = 0: −t·u.
    pub fn slip_offset(&self, contact: &ContactPoint) -> f64 {
        -dot(left(contact.normal), contact.surface_velocity) / self.speed
    }

    /// Speed at which the contact's surface retreats along −`direction` per unit of the pusher's
    /// yield: d·direction, 0 for a fixel.
    pub fn yielding(&self, contact: &ContactPoint, direction: [f64; 2]) -> f64 {
        let yields = contact.yields.filter(|_| self.problem.stall.is_some());
        yields.map_or(0.0, |yields| dot(direction, yields))
    }

    pub fn stall_impulse(&self) -> Option<f64> {
        self.problem.stall.map(|impulse| impulse / self.impulse())
    }

    /// z without any contact or friction impulse.
    pub fn free(&self) -> Column {
        let (m, v, p) = (self.problem.mass, self.problem.twist, self.problem.applied);
        let kick = Twist {
            vx: v.vx + p.fx / m,
            vy: v.vy + p.fy / m,
            omega: v.omega + p.torque / self.problem.inertia,
        };
        self.scale_twist(kick)
    }

    pub fn scale_twist(&self, twist: Twist) -> Column {
        [
            twist.vx / self.speed,
            twist.vy / self.speed,
            self.gyration * twist.omega / self.speed,
        ]
    }

    pub fn unscale_twist(&self, z: &Column) -> Twist {
        Twist {
            vx: self.speed * z[0],
            vy: self.speed * z[1],
            omega: self.speed * z[2] / self.gyration,
        }
    }
}
