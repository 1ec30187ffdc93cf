//! The mixed nonlinear complementarity problem of one time step (docs/method.md (3) to (9), (12);
//! paper eq. 1–2) in SI units: [`StepProblem`] and [`StepSolution`].
//!
//! Unknowns are the twist v⁺, per contact the normal and tangential impulse (p_n, p_t), per foot a
//! planar friction impulse p_k, and the speed y ≥ 0 by which a stalled pusher falls short of its
//! command. Conditions, with W_n = (n, r × n), W_t = (t, r × t), t = n turned by +90°, and u the
//! commanded surface velocity of the other body, d the direction in which it yields:
//!
//! ```text
//! M v⁺ = M v + p_app + Σ W_n p_n + Σ W_t p_t + Σ J_kᵀ p_k
//! 0 ≤ p_n ⟂ W_nᵀ v⁺ + ψ/h − n·(u − y d) ≥ 0
//! |p_t| ≤ μ p_n,  p_t = −μ p_n sign(s) where s = W_tᵀ v⁺ − t·(u − y d) ≠ 0
//! |p_k| ≤ b_k,    p_k = −b_k s_k/|s_k| where s_k = J_k v⁺ ≠ 0
//! 0 ≤ F_stall h − Σ_pusher (p_n n + p_t t)·d ⟂ y ≥ 0
//! ```

use crate::se2::{Twist, Wrench};

/// One point contact of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Unit normal, into the object, world frame.
    pub normal: [f64; 2],
    /// Contact point minus centre of mass, world frame (m).
    pub arm: [f64; 2],
    /// Gap ψ (m); negative is overlap.
    pub gap: f64,
    /// Coulomb friction coefficient.
    pub mu: f64,
    /// Commanded velocity of the other body's surface at the contact point (m/s); zero for a fixel.
    pub surface_velocity: [f64; 2],
    /// On a finger of the pusher, which may stall: unit vector d in which it yields, world frame.
    /// `None` on a fixel.
    pub yields: Option<[f64; 2]>,
}

/// One foot of the support tripod.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Foot {
    /// Foot minus centre of mass, world frame (m).
    pub arm: [f64; 2],
    /// Largest friction impulse μ_s p_ns (N s).
    pub bound: f64,
}

/// One time step's mixed NCP, SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepProblem {
    /// Mass (kg).
    pub mass: f64,
    /// Moment of inertia about the centre of mass (kg m²).
    pub inertia: f64,
    /// Step h (s).
    pub h: f64,
    /// Twist v at the start of the step.
    pub twist: Twist,
    /// Applied impulse p_app + w_app (N s, N s, N m s).
    pub applied: Wrench,
    /// Contacts.
    pub contacts: Vec<ContactPoint>,
    /// The three feet.
    pub feet: [Foot; 3],
    /// F_stall h of the pusher's drive (N s); `None` is a rigid pusher.
    pub stall: Option<f64>,
}

/// Unknowns of a [`StepProblem`], SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepSolution {
    /// Twist v⁺ at the end of the step.
    pub twist: Twist,
    /// Normal impulses p_n (N s), one per contact.
    pub normal: Vec<f64>,
    /// Tangential impulses p_t (N s), one per contact, along t = n turned by +90°.
    pub tangential: Vec<f64>,
    /// Friction impulses of the feet (N s), world frame.
    pub feet: [[f64; 2]; 3],
    /// Speed y by which the pusher falls short of its command (m/s).
    pub pusher_yield: f64,
}
