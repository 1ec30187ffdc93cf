//! Data that the steps of a scene have in common ([`PreparedScene`]), and data that the particles
//! of one step share: its length ([`StepContext`]) and their [`Pushers`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::transform::Transform;
use crate::input::{FingerMotion, MOST_FINGERS, Offsets, PusherMotion};
use crate::scene::Scene;
use crate::se2::{Pose, Twist};
use crate::support::Support;

/// A scene, with quantities derived from it that no step changes.
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
    /// Positions of the feet, see [`Scene::stance`].
    pub stance: [[f64; 2]; 3],
    /// Places of the fixels.
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

    /// Asserts that a pusher has as many fingers as the scene's.
    pub fn check(&self, pusher: &PusherMotion) {
        assert_eq!(
            pusher.len(),
            self.scene.pusher.fingers.len(),
            "a motion for each of the pusher's fingers"
        );
    }

    /// Motion of one finger in a step of several particles, each with its own pusher.
    pub fn finger<const W: usize>(
        &self,
        pushers: &[Option<PusherMotion>; W],
        finger: usize,
    ) -> Option<FingerContext<W>> {
        let first = pushers.iter().flatten().next()?;
        pushers
            .iter()
            .flatten()
            .for_each(|pusher| self.check(pusher));
        let mut context: FingerContext<W> = SharedFinger::new(self, first, finger).splat();
        for (lane, pusher) in pushers.iter().enumerate() {
            context.present.set(lane, pusher.is_some());
            if let Some(pusher) = pusher {
                context.set(self, lane, pusher, finger);
            }
        }
        Some(context)
    }
}

/// The length of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepContext {
    /// h (s).
    pub h: f64,
    /// 1/h (1/s).
    pub rate: f64,
}

impl StepContext {
    pub fn new(h: f64) -> Self {
        Self { h, rate: 1.0 / h }
    }
}

/// Bodies that the particles of one chunk meet in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepBodies<'a, const W: usize> {
    pub context: &'a StepContext,
    /// The pusher of every chunk.
    pub pushers: &'a Pushers<'a, W>,
    /// Number of this one.
    pub chunk: usize,
    /// Offsets of the fixels (m); none where they stand as the scene says.
    pub fixel_offsets: &'a [[Lanes<W>; 2]],
    /// Image of the scene's feet; `None` where they stand as in the scene.
    pub support: Option<&'a Support<Lanes<W>>>,
}

/// The pusher of every chunk of particles in one step, and where the fixels stand.
#[derive(Clone, Copy, Debug)]
pub enum Pushers<'a, const W: usize> {
    /// One pusher for all particles.
    Shared(SharedPusher),
    /// One for each particle: the fingers of the first chunk, then those of the second, ...
    Each {
        /// A finger is `None` while it is off the plane in every lane.
        contexts: &'a [Option<FingerContext<W>>],
        /// Number of fingers.
        fingers: usize,
    },
    /// One pusher for all particles, offset from its pose, and fixels offset from theirs.
    Offset {
        /// The pusher at its pose.
        pusher: SharedPusher,
        /// Offsets of the pusher and of the fixels.
        offsets: Offsets<'a, W>,
        /// Number of fingers.
        fingers: usize,
        /// Number of fixels.
        fixels: usize,
    },
}

/// One pusher for all particles; its lanes are made where they are used.
#[derive(Clone, Copy, Debug)]
pub struct SharedPusher {
    /// None while it is off the plane.
    fingers: [Option<SharedFinger>; MOST_FINGERS],
}

/// One finger for all particles: its motion, where it stands, and the speed of its fastest point.
#[derive(Clone, Copy, Debug)]
struct SharedFinger(FingerMotion, Transform, f64);

/// A finger's motion and where it stands, lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct FingerContext<const W: usize> {
    pub(crate) motion: FingerMotion<Lanes<W>>,
    pub(crate) transform: Transform<Lanes<W>>,
    /// Speed of its fastest point (m/s).
    pub(crate) speed: Lanes<W>,
    /// The lanes in which it is on the plane.
    pub(crate) present: Mask<W>,
}

impl SharedPusher {
    pub(crate) fn new(scene: &PreparedScene, pusher: Option<&PusherMotion>) -> Self {
        let mut fingers = [None; MOST_FINGERS];
        if let Some(pusher) = pusher {
            scene.check(pusher);
            for (i, finger) in fingers.iter_mut().enumerate().take(pusher.len()) {
                *finger = Some(SharedFinger::new(scene, pusher, i));
            }
        }
        Self { fingers }
    }

    /// One finger in every lane; `None` while it is off the plane.
    #[inline(always)]
    fn splat<const W: usize>(&self, finger: usize) -> Option<FingerContext<W>> {
        self.fingers[finger].as_ref().map(SharedFinger::splat)
    }
}

impl SharedFinger {
    fn new(scene: &PreparedScene, pusher: &PusherMotion, finger: usize) -> Self {
        let motion = pusher[finger];
        let Twist { vx, vy, omega } = motion.twist;
        // the finger's fastest point
        let radius = scene.scene.pusher.fingers[finger].bounding_radius();
        let speed = (vx * vx + vy * vy).sqrt() + omega.abs() * radius;
        Self(motion, Transform::from(motion.pose), speed)
    }

    /// It in every lane.
    #[inline(always)]
    fn splat<const W: usize>(&self) -> FingerContext<W> {
        let Self(motion, transform, speed) = self;
        FingerContext {
            motion: motion.splat(),
            transform: transform.splat(),
            speed: Lanes::splat(*speed),
            present: Mask::splat(true),
        }
    }
}

impl<const W: usize> Pushers<'_, W> {
    /// One finger of one chunk; `None` while it is off the plane in every lane.
    #[inline(always)]
    pub fn finger(&self, chunk: usize, finger: usize) -> Option<FingerContext<W>> {
        match self {
            Self::Shared(pusher) => pusher.splat(finger),
            Self::Each { contexts, fingers } => contexts[chunk * fingers + finger],
            Self::Offset {
                pusher,
                offsets,
                fingers,
                ..
            } => {
                let mut context: FingerContext<W> = pusher.splat(finger)?;
                let [x, y] = offsets.pusher[chunk * fingers + finger];
                context.motion.pose.x += x;
                context.motion.pose.y += y;
                context.transform.origin[0] += x;
                context.transform.origin[1] += y;
                if let Some(turn) = offsets.pusher_turn.get(chunk) {
                    context.motion.pose.theta += *turn;
                    context.transform = Transform::from(context.motion.pose);
                }
                Some(context)
            }
        }
    }

    /// True if the pusher is on the plane in some lane of a chunk.
    #[inline(always)]
    pub fn is_present(&self, chunk: usize) -> bool {
        match self {
            Self::Shared(pusher) | Self::Offset { pusher, .. } => pusher.fingers[0].is_some(),
            Self::Each { contexts, fingers } => contexts[chunk * fingers].is_some(),
        }
    }

    /// Speed of the fastest point of the pushers of a chunk (m/s); 0 off the plane.
    #[inline(always)]
    pub fn speed(&self, chunk: usize, fingers: usize) -> Lanes<W> {
        let of = |finger: usize| match self {
            Self::Shared(pusher) | Self::Offset { pusher, .. } => match &pusher.fingers[finger] {
                Some(SharedFinger(.., speed)) => Lanes::splat(*speed),
                None => Lanes::ZERO,
            },
            Self::Each { contexts, fingers } => match &contexts[chunk * fingers + finger] {
                Some(context) => context.speed,
                None => Lanes::ZERO,
            },
        };
        let mut fastest = of(0);
        for finger in 1..fingers {
            fastest = fastest.max(of(finger));
        }
        fastest
    }

    /// Offsets of the fixels (m) for one chunk; none where they stand as the scene says.
    #[inline(always)]
    pub fn fixel_offsets(&self, chunk: usize) -> &[[Lanes<W>; 2]] {
        match self {
            Self::Offset {
                offsets, fixels, ..
            } => &offsets.fixels[chunk * fixels..][..*fixels],
            _ => &[],
        }
    }

    /// Images of the scene's feet in one chunk; `None` where they stand as in the scene.
    #[inline(always)]
    pub fn support(&self, chunk: usize) -> Option<&Support<Lanes<W>>> {
        match self {
            Self::Offset { offsets, .. } => offsets.supports.get(chunk),
            _ => None,
        }
    }
}

impl<const W: usize> FingerContext<W> {
    /// Overwrites one lane.
    fn set(&mut self, scene: &PreparedScene, lane: usize, pusher: &PusherMotion, finger: usize) {
        let alone: FingerContext<1> = SharedFinger::new(scene, pusher, finger).splat();
        for (to, from) in self.numbers_mut().into_iter().zip(alone.numbers()) {
            to.0[lane] = from.0[0];
        }
    }

    /// One lane.
    pub(crate) fn lane(&self, lane: usize) -> FingerContext<1> {
        let alone = |x: Lanes<W>| Lanes([x.0[lane]]);
        let Self {
            motion, transform, ..
        } = self;
        FingerContext {
            motion: FingerMotion {
                pose: motion.pose.map(alone),
                twist: motion.twist.map(alone),
                direction: motion.direction.map(alone),
            },
            transform: Transform {
                origin: transform.origin.map(alone),
                cos: alone(transform.cos),
                sin: alone(transform.sin),
            },
            speed: alone(self.speed),
            present: Mask::splat(self.present.lane(lane)),
        }
    }

    fn numbers(&self) -> [&Lanes<W>; 13] {
        let FingerMotion {
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
        let FingerMotion {
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
