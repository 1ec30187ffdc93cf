//! Compliant contacts with friction: [`ContactLaw`], [`Touch`].
//!
//! A spring and a damper push bodies apart that overlap; they never pull. Along the tangent a
//! bristle stretches with the slip, and pulls with at most μ times the normal force.

use stickslip_dynamics::Gap;

/// How far a contact point may move on the object within one step and still be the same contact
/// (m).
const SAME: f64 = 1e-3;

/// What contacts are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLaw {
    /// Normal force per depth of overlap, of one contact point (N/m).
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

/// Forces of one contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Press {
    /// Along the normal, into the object (N).
    pub normal: f64,
    /// Along the tangent, the normal turned by +90° (N).
    pub tangential: f64,
}

/// Relative motion at one contact point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slide {
    /// Rate of the gap (m/s).
    pub parting: f64,
    /// Slip of the object along the tangent (m/s).
    pub slip: f64,
}

/// A contact point that lasts, with its bristle.
#[derive(Clone, Copy, Debug)]
struct Spot {
    arm: [f64; 2],
    /// Stretch of the bristle along the tangent (m).
    stretch: f64,
}

/// The contact points of the object with one body.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    mu: f64,
    spots: Vec<Spot>,
    next: Vec<Spot>,
}

impl Touch {
    /// No contact yet, with a body of this friction.
    pub(super) fn new(mu: f64) -> Self {
        Self {
            mu,
            spots: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Forces of one contact point of this step, whose gap is negative; `mass` is the object's
    /// (kg), `h` the step (s).
    pub(super) fn press(
        &mut self,
        law: &ContactLaw,
        gap: &Gap,
        slide: Slide,
        [mass, h]: [f64; 2],
    ) -> Press {
        let damping = 2.0 * law.damping_ratio * (law.stiffness * mass).sqrt();
        let normal = (-law.stiffness * gap.gap - damping * slide.parting).max(0.0);

        let (stiffness, damping) = (
            law.tangential * law.stiffness,
            law.tangential.sqrt() * damping,
        );
        let limit = self.mu * normal;
        let held = (stiffness * (self.stretch(gap.arm) + h * slide.slip)).clamp(-limit, limit);
        self.next.push(Spot {
            arm: gap.arm,
            stretch: held / stiffness,
        });
        Press {
            normal,
            tangential: -(held + damping * slide.slip).clamp(-limit, limit),
        }
    }

    /// Ends a step: contact points that were not pressed are forgotten.
    pub(super) fn settle(&mut self) {
        std::mem::swap(&mut self.spots, &mut self.next);
        self.next.clear();
    }

    /// Stretch of the bristle that was nearest in the step before; a new one is relaxed.
    fn stretch(&self, arm: [f64; 2]) -> f64 {
        let distance = |spot: &Spot| {
            (spot.arm[0] - arm[0]) * (spot.arm[0] - arm[0])
                + (spot.arm[1] - arm[1]) * (spot.arm[1] - arm[1])
        };
        let near = self
            .spots
            .iter()
            .map(|spot| (distance(spot), spot.stretch))
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        near.filter(|(square, _)| *square < SAME * SAME)
            .map_or(0.0, |(_, stretch)| stretch)
    }
}
