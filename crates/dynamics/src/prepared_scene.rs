//! What the steps of a scene have in common ([`PreparedScene`]), and what the particles of one step
//! have ([`StepContext`]).

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::transform::Transform;
use crate::input::{PusherMotion, StepInput};
use crate::scene::Scene;
use crate::se2::{Pose, Twist};

/// A scene, with what of it no step changes.
#[derive(Clone, Debug)]
pub(crate) struct PreparedScene {
    pub scene: Scene,
    /// The object's radius of gyration ρ (m).
    pub rho: f64,
    /// Reciprocals of ρ, of the object's mass and of its moment of inertia: division is the slowest
    /// vector instruction.
    pub inv_rho: f64,
    pub inv_mass: f64,
    pub inv_inertia: f64,
    /// Where the feet stand, see [`Scene::stance`].
    pub stance: [[f64; 2]; 3],
    /// Where the fixels stand.
    pub fixels: Vec<Transform>,
}

impl PreparedScene {
    pub fn new(scene: Scene) -> Self {
        let (mass, inertia) = (scene.object.mass, scene.object.inertia);
        let rho = scene.object.gyration_radius();
        let fixels = scene.fixels.iter();
        Self {
            rho,
            inv_rho: 1.0 / rho,
            inv_mass: 1.0 / mass,
            inv_inertia: 1.0 / inertia,
            stance: scene.stance(),
            fixels: fixels.map(|fixel| Transform::from(fixel.pose)).collect(),
            scene,
        }
    }

    /// What the pusher does in a step of several particles, each with its own.
    pub fn pushers<const W: usize>(
        &self,
        pushers: &[Option<PusherMotion>; W],
    ) -> Option<PusherContext<W>> {
        let first = pushers.iter().flatten().next()?;
        let mut context = PusherContext::same(self, first);
        for (lane, pusher) in pushers.iter().enumerate() {
            context.present.set(lane, pusher.is_some());
            if let Some(pusher) = pusher {
                context.set(self, lane, pusher);
            }
        }
        Some(context)
    }
}

/// What the particles of a chunk share in one step, and what drives each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepContext<'a, const W: usize> {
    /// h (s).
    pub h: f64,
    /// 1/h (1/s).
    pub rate: f64,
    pub pushers: Pushers<'a, W>,
}

/// The pusher of every chunk of particles.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pushers<'a, const W: usize> {
    /// The same for all; `None` while it is off the plane.
    Shared(Option<PusherContext<W>>),
    /// One for each particle, chunk by chunk.
    Each(&'a [Option<PusherContext<W>>]),
}

/// A pusher's motion and where it stands, lane by lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PusherContext<const W: usize> {
    pub motion: PusherMotion<Lanes<W>>,
    pub transform: Transform<Lanes<W>>,
    /// Speed of its fastest point (m/s).
    pub speed: Lanes<W>,
    /// The lanes in which it is on the plane.
    pub present: Mask<W>,
}

impl<'a, const W: usize> StepContext<'a, W> {
    /// One input for all particles.
    #[inline(always)]
    pub fn shared(scene: &PreparedScene, input: &StepInput) -> Self {
        let pusher = input.pusher.as_ref();
        Self {
            h: input.h,
            rate: 1.0 / input.h,
            pushers: Pushers::Shared(pusher.map(|pusher| PusherContext::same(scene, pusher))),
        }
    }

    /// Every particle with a pusher of its own.
    #[inline(always)]
    pub fn each(h: f64, pushers: &'a [Option<PusherContext<W>>]) -> Self {
        Self {
            h,
            rate: 1.0 / h,
            pushers: Pushers::Each(pushers),
        }
    }

    /// The pusher of one chunk.
    #[inline(always)]
    pub fn pusher(&self, chunk: usize) -> Option<&PusherContext<W>> {
        match &self.pushers {
            Pushers::Shared(pusher) => pusher.as_ref(),
            Pushers::Each(pushers) => pushers[chunk].as_ref(),
        }
    }
}

impl<const W: usize> PusherContext<W> {
    /// The same pusher in every lane.
    #[inline(always)]
    fn same(scene: &PreparedScene, pusher: &PusherMotion) -> Self {
        Self {
            motion: pusher.splat(),
            transform: Transform::from(pusher.pose).splat(),
            speed: Lanes::splat(fastest_point(scene, &pusher.twist)),
            present: Mask::splat(true),
        }
    }

    /// Overwrites one lane.
    fn set(&mut self, scene: &PreparedScene, lane: usize, pusher: &PusherMotion) {
        let alone = PusherContext::<1>::same(scene, pusher);
        for (to, from) in self.numbers_mut().into_iter().zip(alone.numbers()) {
            to.0[lane] = from.0[0];
        }
    }

    fn numbers(&self) -> [&Lanes<W>; 13] {
        let PusherMotion {
            pose: Pose { x, y, theta },
            twist: Twist { vx, vy, omega },
            direction: [dx, dy],
        } = &self.motion;
        let Transform {
            origin: [ox, oy],
            cos,
            sin,
        } = &self.transform;
        let speed = &self.speed;
        [x, y, theta, vx, vy, omega, dx, dy, ox, oy, cos, sin, speed]
    }

    fn numbers_mut(&mut self) -> [&mut Lanes<W>; 13] {
        let PusherMotion {
            pose: Pose { x, y, theta },
            twist: Twist { vx, vy, omega },
            direction: [dx, dy],
        } = &mut self.motion;
        let Transform {
            origin: [ox, oy],
            cos,
            sin,
        } = &mut self.transform;
        let speed = &mut self.speed;
        [x, y, theta, vx, vy, omega, dx, dy, ox, oy, cos, sin, speed]
    }
}

/// Speed of the pusher's fastest point (m/s).
fn fastest_point(scene: &PreparedScene, twist: &Twist) -> f64 {
    let radius = scene.scene.pusher.shape.bounding_radius();
    (twist.vx * twist.vx + twist.vy * twist.vy).sqrt() + twist.omega.abs() * radius
}
