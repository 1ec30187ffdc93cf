//! Where the support's feet stand, and what friction each can bear (docs/method.md (7)).

use stickslip_lanes::Lanes;

use crate::friction::Friction;
use crate::geometry::transform::Transform;
use crate::ncp::problem::Foot;
use crate::scene::{Feet, Scene};
use crate::se2::Pose;

impl Scene {
    /// Where the feet stand in the object's frame (m); those of a tripod of radius 1.
    pub(crate) fn stance(&self) -> [[f64; 2]; 3] {
        match self.feet {
            Feet::Tripod { angle } => [0.0, 1.0, -1.0].map(|turn| {
                let (sin, cos) = libm::sincos(angle + turn * (2.0 / 3.0 * std::f64::consts::PI));
                [cos, sin]
            }),
            Feet::Known { positions, .. } => positions,
        }
    }

    /// The feet's arms in the world frame (m) of turned objects; `d_tri` is the radius of a tripod
    /// (m).
    #[inline(always)]
    pub(crate) fn foot_arms<const W: usize>(
        &self,
        stance: &[[f64; 2]; 3],
        object: &Transform<Lanes<W>>,
        (d_tri, frame): (Lanes<W>, Option<&Pose<Lanes<W>>>),
    ) -> [[Lanes<W>; 2]; 3] {
        let radius = match self.feet {
            Feet::Tripod { .. } => d_tri,
            Feet::Known { .. } => Lanes::splat(1.0),
        };
        let Some(frame) = frame else {
            return stance.map(|place| object.rotate(place).map(|x| radius * x));
        };
        let frame = Transform::from(*frame);
        stance.map(|place| object.rotate(frame.transform_point(place.map(|x| radius * x))))
    }

    /// Each foot's share of the weight.
    pub(crate) fn foot_loads(&self) -> [f64; 3] {
        match self.feet {
            Feet::Tripod { .. } => [1.0 / 3.0; 3],
            Feet::Known { loads, .. } => loads,
        }
    }

    /// The feet of an object at angle `theta`: arms in the world frame, friction bounds for a step
    /// of `h` seconds.
    pub fn feet_at(&self, theta: f64, friction: &Friction, h: f64) -> [Foot; 3] {
        let total = friction.mu_s * self.object.mass * self.gravity * h;
        let object = Transform::from(Pose::new(0.0, 0.0, theta).map(|x| Lanes([x])));
        let arms = self.foot_arms(&self.stance(), &object, (Lanes([friction.d_tri]), None));
        let loads = self.foot_loads();
        std::array::from_fn(|k| Foot {
            arm: arms[k].map(|x| x.0[0]),
            bound: total * loads[k],
        })
    }
}
