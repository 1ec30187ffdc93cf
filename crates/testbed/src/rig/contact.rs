//! Compliant contacts with friction: [`ContactLaw`], [`CompliantContact`].
//!
//! A spring and a damper push overlapping bodies apart; they never pull. Along the tangent a
//! bristle stretches with the slip, and pulls with at most μ times the normal force.

use stickslip_dynamics::Gap;

/// Distance that a contact point may move on the object within one step and keep its bristle (m).
const SAME_POINT: f64 = 1e-3;

/// Stiffness and damping of contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLaw {
    /// Normal stiffness of one contact point (N/m).
    pub stiffness: f64,
    /// Damping ratio of the object's mass on that spring.
    pub damping_ratio: f64,
    /// Tangential stiffness as a share of the normal one.
    pub tangential: f64,
}

impl Default for ContactLaw {
    fn default() -> Self {
        Self {
            stiffness: 2e5,
            damping_ratio: 0.6,
            tangential: 0.7,
        }
    }
}

/// Force on the object at one contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactForce {
    /// Along the normal, into the object (N).
    pub normal: f64,
    /// Along the tangent, the normal turned by +90° (N).
    pub tangential: f64,
}

/// Relative motion at one contact point.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeMotion {
    /// Rate of the gap (m/s).
    pub gap_rate: f64,
    /// Slip of the object along the tangent (m/s).
    pub slip: f64,
}

/// The bristle of a contact point.
#[derive(Clone, Copy, Debug)]
struct Bristle {
    /// The contact point from the object's origin (m).
    arm: [f64; 2],
    /// Stretch along the tangent (m).
    stretch: f64,
}

/// The contact points of the object with one body.
#[derive(Clone, Debug)]
pub(super) struct CompliantContact {
    mu: f64,
    bristles: Vec<Bristle>,
    next: Vec<Bristle>,
}

impl CompliantContact {
    /// No contact yet, with a body of this friction.
    pub(super) fn new(mu: f64) -> Self {
        Self {
            mu,
            bristles: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Force at one contact point in this step; its gap is negative. `mass` is the object's (kg),
    /// `h` the step (s).
    pub(super) fn force(
        &mut self,
        law: &ContactLaw,
        gap: &Gap,
        relative: RelativeMotion,
        [mass, h]: [f64; 2],
    ) -> ContactForce {
        let damping = 2.0 * law.damping_ratio * (law.stiffness * mass).sqrt();
        let normal = (-law.stiffness * gap.gap - damping * relative.gap_rate).max(0.0);

        let (stiffness, damping) = (
            law.tangential * law.stiffness,
            law.tangential.sqrt() * damping,
        );
        let limit = self.mu * normal;
        let held = (stiffness * (self.stretch(gap.arm) + h * relative.slip)).clamp(-limit, limit);
        self.next.push(Bristle {
            arm: gap.arm,
            stretch: held / stiffness,
        });
        ContactForce {
            normal,
            tangential: -(held + damping * relative.slip).clamp(-limit, limit),
        }
    }

    /// Ends a step: bristles of contact points without a force in it are dropped.
    pub(super) fn end_step(&mut self) {
        std::mem::swap(&mut self.bristles, &mut self.next);
        self.next.clear();
    }

    /// Stretch of the bristle that was nearest in the step before; a new one is relaxed.
    fn stretch(&self, arm: [f64; 2]) -> f64 {
        let distance = |bristle: &Bristle| {
            (bristle.arm[0] - arm[0]) * (bristle.arm[0] - arm[0])
                + (bristle.arm[1] - arm[1]) * (bristle.arm[1] - arm[1])
        };
        let near = self
            .bristles
            .iter()
            .map(|bristle| (distance(bristle), bristle.stretch))
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        near.filter(|(square, _)| *square < SAME_POINT * SAME_POINT)
            .map_or(0.0, |(_, stretch)| stretch)
    }
}
