//! Poses of bodies next to an object: [`Standing`].

use stickslip_dynamics::{Part, Placed, Pose, Shape, narrow_phase};

use stickslip_testkit::{dot, left};

/// Steps from far away to the object's centre in which the first overlap is looked for.
const MARCH: usize = 200;

/// Halvings of the way between apart and overlapping.
const HALVINGS: usize = 60;

/// An object at a pose, next to which other bodies are put.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing<'a> {
    pub shape: &'a Shape,
    pub pose: Pose,
}

/// On which side of the object a body is put.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Unit vector from the object to the body, world frame.
    pub towards: [f64; 2],
    /// Shift of the body's origin along `towards` turned by +90° (m).
    pub lateral: f64,
    /// Gap between the two along `towards` (m); 0 is a touch.
    pub clearance: f64,
}

impl Side {
    /// The side in direction `angle` (rad).
    pub fn at(angle: f64, lateral: f64, clearance: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self {
            towards: [cos, sin],
            lateral,
            clearance,
        }
    }
}

impl Standing<'_> {
    /// The pose of `body`, turned by `theta` (rad), that comes nearest on this side. A body that
    /// passes the object stands level with its centre.
    pub fn beside(&self, body: &Shape, theta: f64, side: &Side) -> Pose {
        let across = left(side.towards);
        let at = |distance: f64| {
            let along = |k: usize| distance * side.towards[k] + side.lateral * across[k];
            Pose::new(self.pose.x + along(0), self.pose.y + along(1), theta)
        };
        let far = self.shape.bounding_radius() + body.bounding_radius() + side.lateral.abs();
        let overlaps = |distance: f64| self.overlaps(body, at(distance));
        let step = far / MARCH as f64;
        let Some(first) = (0..MARCH)
            .map(|k| far - step * k as f64)
            .find(|distance| overlaps(*distance))
        else {
            return at(0.0);
        };
        let (mut inside, mut outside) = (first, first + step);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if overlaps(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        at(outside + side.clearance)
    }

    /// Returns true if the object overlaps `body`.
    pub fn overlaps(&self, body: &Shape, pose: Pose) -> bool {
        let mut gaps = Vec::new();
        let (object, other) = (Placed::new(self.shape, self.pose), Placed::new(body, pose));
        narrow_phase(&object, &other, 1e-6, &mut gaps);
        gaps.iter().any(|gap| gap.gap < 0.0)
    }

    /// Extent of the object from its origin along a unit vector of the world (m).
    pub fn reach(&self, direction: [f64; 2]) -> f64 {
        let direction = Pose::new(0.0, 0.0, -self.pose.theta).rotate(direction);
        self.shape
            .parts()
            .iter()
            .map(|part| support(part, direction))
            .fold(f64::MIN, f64::max)
    }
}

/// Support function of a part: the largest projection of its points on a unit vector (m).
fn support(part: &Part, direction: [f64; 2]) -> f64 {
    match part {
        Part::Polygon { vertices } => vertices
            .iter()
            .map(|vertex| dot(*vertex, direction))
            .fold(f64::MIN, f64::max),
        Part::Disc { radius, centre } => dot(*centre, direction) + radius,
    }
}
