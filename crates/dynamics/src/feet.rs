//! Positions of the support's feet, and the friction that each can bear (docs/method.md (7)).

use stickslip_lanes::Lanes;

use crate::friction::Friction;
use crate::geometry::transform::Transform;
use crate::ncp::problem::Foot;
use crate::scene::{Feet, Scene};
use crate::se2::Pose;
use crate::support::Support;

impl Scene {
    /// Positions of the feet in the object's frame (m); those of a tripod of radius 1.
    pub(crate) fn stance(&self) -> [[f64; 2]; 3] {
        match self.feet {
            Feet::Tripod { angle } => [0.0, 1.0, -1.0].map(|turn| {
                let (sin, cos) = libm::sincos(angle + turn * (2.0 / 3.0 * std::f64::consts::PI));
                [cos, sin]
            }),
            Feet::Known { positions, .. } => positions,
        }
    }

    /// Arms of the feet in the world frame (m) of turned objects; `d_tri` is the radius of a tripod
    /// (m), `support` an image of the scene's feet.
    #[inline(always)]
    pub(crate) fn foot_arms<const W: usize>(
        &self,
        stance: &[[f64; 2]; 3],
        object: &Transform<Lanes<W>>,
        (d_tri, support): (Lanes<W>, Option<&Support<Lanes<W>>>),
    ) -> [[Lanes<W>; 2]; 3] {
        let radius = match self.feet {
            Feet::Tripod { .. } => d_tri,
            Feet::Known { .. } => Lanes::splat(1.0),
        };
        let Some(support) = support else {
            return stance.map(|place| object.rotate(place).map(|x| radius * x));
        };
        let centre = self.centre_of_friction();
        stance.map(|place| {
            let [x, y] = std::array::from_fn(|k| radius * place[k] - centre[k]);
            object.rotate(std::array::from_fn(|k| {
                let [along_x, along_y] = support.map[k];
                support.centre[k] + (along_x * x + along_y * y) + centre[k]
            }))
        })
    }

    /// Centre of friction in the object's frame (m): where the feet's friction acts on an object
    /// that slides without turning.
    fn centre_of_friction(&self) -> [f64; 2] {
        match self.feet {
            Feet::Tripod { .. } => [0.0; 2],
            Feet::Known { positions, loads } => {
                let sum =
                    |axis: usize| (0..3).map(|foot| loads[foot] * positions[foot][axis]).sum();
                [sum(0), sum(1)]
            }
        }
    }

    /// Three known feet: the image of the scene's.
    #[must_use]
    pub fn image_of_feet(&self, support: &Support) -> Feet {
        let alone = support.map(|x| Lanes([x]));
        let object = Transform::from(Pose::default().map(|x: f64| Lanes([x])));
        let d_tri = Lanes([self.nominal.d_tri]);
        let arms = self.foot_arms(&self.stance(), &object, (d_tri, Some(&alone)));
        Feet::Known {
            positions: arms.map(|arm| arm.map(|x| x.0[0])),
            loads: self.foot_loads(),
        }
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
