//! Many pushes at once, each over many steps: [`Dynamics::rollout`].

use crate::friction::Friction;
use crate::input::PusherMotion;
use crate::ncp::report::Outcome;
use crate::particles::{Particle, Particles};
use crate::se2::{Pose, Twist};
use crate::step::{Dynamics, StepWork};

/// Trajectories side by side.
const LANES: usize = 8;

/// Chunks of trajectories that make their steps together.
const CHUNKS: usize = 8;

/// Where a trajectory starts, and the friction that governs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutStart {
    /// Pose of the object.
    pub pose: Pose,
    /// Twist of the object.
    pub twist: Twist,
    /// Friction parameters.
    pub friction: Friction,
}

/// N trajectories of T steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rollout {
    /// T.
    pub steps: usize,
    /// Poses of the object (m, m, rad), (N, T + 1): trajectory after trajectory, its start first.
    pub poses: Vec<Pose>,
    /// Twists of the object (m/s, m/s, rad/s), (N, T + 1).
    pub twists: Vec<Twist>,
    /// Steps without a certified solution, (N,).
    pub unsolved: Vec<u32>,
}

/// Why a rollout was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RolloutError {
    /// The pushers' poses do not go with the starts.
    #[error(
        "there are {poses} pusher poses for {starts} trajectories; give T + 1 of each trajectory, at least 2, one trajectory after the other"
    )]
    Shape {
        /// Number of trajectories.
        starts: usize,
        /// Number of pusher poses.
        poses: usize,
    },
    /// The step is not positive.
    #[error("the step is {h} s; it must be finite and above 0; try 1/30")]
    Step {
        /// The step found (s).
        h: f64,
    },
    /// A start or a pusher pose is NaN or infinite.
    #[error("{what} {index} of trajectory {trajectory} is not finite; all its numbers must be")]
    NotFinite {
        /// `start` or `pusher pose`.
        what: &'static str,
        /// Its number within the trajectory, from 0.
        index: usize,
        /// The trajectory, from 0.
        trajectory: usize,
    },
}

impl Dynamics {
    /// Simulates one trajectory per start: T steps of `h` seconds (docs/method.md (11)), driven by a
    /// pusher of its own.
    ///
    /// `pushers` holds the pusher's poses where steps begin and end, (N, T + 1), trajectory after
    /// trajectory: start i under pusher i. The pusher moves straight from one to the next; where the
    /// scene gives it a stall force, it may fall behind, by as much as the object holds it back. A trajectory depends on nothing but its start and its pusher, and
    /// is the same, bit for bit, as step by step with [`Dynamics::step`]. One thread runs; share the
    /// starts among threads for more.
    ///
    /// Two starts, and two pushes that end 1 mm and 11 mm beyond the first touch:
    ///
    /// ```
    /// # use stickslip_dynamics::{Dynamics, Feet, Friction, Object, Part, Pose, Pusher, RolloutStart, Scene, Shape, Twist};
    /// # let disc = |radius| Shape::new(vec![Part::Disc { radius, centre: [0.0, 0.0] }]);
    /// # let friction = Friction { mu_s: 0.3, mu_p: 0.3, mu_f: 0.3, d_tri: 0.02 };
    /// # let object = Object { mass: 0.5, inertia: 2e-4, shape: disc(0.03)? };
    /// # let pusher = Pusher { shape: disc(0.005)?, stall_force: None };
    /// # let feet = Feet::Tripod { angle: 0.0 };
    /// let scene = Scene { gravity: 9.81, object, feet, pusher, fixels: vec![], nominal: friction };
    /// let at = |pose| RolloutStart { pose, twist: Twist::default(), friction };
    /// let starts = [at(Pose::default()), at(Pose::new(0.0, 0.001, 0.0))];
    /// let push = |speed: f64| (0..=30).map(move |k| Pose::new(-0.035 + speed * f64::from(k) / 30.0, 0.0, 0.0));
    /// let pushers: Vec<Pose> = push(0.001).chain(push(0.011)).collect();
    /// let rollout = Dynamics::new(scene).rollout(1.0 / 30.0, &starts, &pushers)?;
    /// let ends: Vec<f64> = rollout.poses.chunks(31).map(|poses| poses[30].x).collect();
    /// assert!((ends[0] - 0.001).abs() < 1e-4 && (ends[1] - 0.011).abs() < 1e-3, "{ends:?}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where the poses do not go with the starts, or a number is out of range.
    pub fn rollout(
        &self,
        h: f64,
        starts: &[RolloutStart],
        pushers: &[Pose],
    ) -> Result<Rollout, RolloutError> {
        let rows = check(h, starts, pushers)?;
        let mut rollout = Rollout {
            steps: rows - 1,
            poses: vec![Pose::default(); pushers.len()],
            twists: vec![Twist::default(); pushers.len()],
            unsolved: vec![0; starts.len()],
        };
        let mut work = StepWork::default();
        for first in (0..starts.len()).step_by(LANES * CHUNKS) {
            let last = starts.len().min(first + LANES * CHUNKS);
            let of = first * rows..last * rows;
            let mut block = Block {
                rows,
                pushers: &pushers[of.clone()],
                poses: &mut rollout.poses[of.clone()],
                twists: &mut rollout.twists[of],
                unsolved: &mut rollout.unsolved[first..last],
            };
            block.simulate(self, h, &starts[first..last], &mut work);
        }
        Ok(rollout)
    }
}

/// Poses per trajectory, T + 1; refuses what cannot be simulated.
fn check(h: f64, starts: &[RolloutStart], pushers: &[Pose]) -> Result<usize, RolloutError> {
    if !(h.is_finite() && h > 0.0) {
        return Err(RolloutError::Step { h });
    }
    let rows = pushers.len() / starts.len().max(1);
    if rows * starts.len() != pushers.len() || (rows < 2 && !starts.is_empty()) {
        return Err(RolloutError::Shape {
            starts: starts.len(),
            poses: pushers.len(),
        });
    }
    let not_finite = |what, index, trajectory| {
        Err(RolloutError::NotFinite {
            what,
            index,
            trajectory,
        })
    };
    if let Some(trajectory) = starts.iter().position(|start| !start.is_finite()) {
        return not_finite("start", 0, trajectory);
    }
    match pushers.iter().position(|pose| !pose.is_finite()) {
        Some(at) => not_finite("pusher pose", at % rows, at / rows),
        None => Ok(rows.max(1)),
    }
}

impl RolloutStart {
    fn is_finite(&self) -> bool {
        let twist = self.twist.fields().into_iter().all(|x| x.is_finite());
        let friction = self.friction.fields().into_iter().all(|x| x.is_finite());
        self.pose.is_finite() && twist && friction
    }
}

/// Some trajectories, which make their steps together.
struct Block<'a> {
    /// Poses per trajectory.
    rows: usize,
    pushers: &'a [Pose],
    poses: &'a mut [Pose],
    twists: &'a mut [Twist],
    unsolved: &'a mut [u32],
}

impl Block<'_> {
    fn simulate(
        &mut self,
        dynamics: &Dynamics,
        h: f64,
        starts: &[RolloutStart],
        work: &mut StepWork<LANES>,
    ) {
        // lanes past the last trajectory repeat it, without a pusher
        let chunks = starts.len().div_ceil(LANES);
        let mut particles = [Particles::default(); CHUNKS];
        for i in 0..chunks * LANES {
            let start = &starts[i.min(starts.len() - 1)];
            let particle = Particle {
                pose: start.pose,
                twist: start.twist,
                ..Particle::default()
            };
            particles[i / LANES].set(i % LANES, &particle, &start.friction);
        }
        self.write(0, &particles);

        let mut directions: Vec<[f64; 2]> = (0..starts.len())
            .map(|i| first_direction(&self.pushers[i * self.rows..(i + 1) * self.rows]))
            .collect();
        let mut pushers = [[None; LANES]; CHUNKS];
        for step in 0..self.rows - 1 {
            // the pusher of each trajectory, straight from pose to pose
            for (i, direction) in directions.iter_mut().enumerate() {
                let at = i * self.rows + step;
                let motion = motion(self.pushers[at], self.pushers[at + 1], h, *direction);
                *direction = motion.direction;
                pushers[i / LANES][i % LANES] = Some(motion);
            }

            dynamics.step_block_each(h, &pushers[..chunks], &mut particles[..chunks], work);

            self.write(step + 1, &particles);
            let reports = work.reports().as_flattened();
            for (unsolved, report) in self.unsolved.iter_mut().zip(reports) {
                *unsolved += u32::from(report.outcome != Outcome::Solved);
            }
        }
    }

    /// Writes where the object is at row `row` of each trajectory.
    fn write(&mut self, row: usize, particles: &[Particles<LANES>]) {
        for i in 0..self.unsolved.len() {
            let particle = &particles[i / LANES];
            self.poses[i * self.rows + row] = particle.pose.map(|x| x.0[i % LANES]);
            self.twists[i * self.rows + row] = particle.twist.map(|x| x.0[i % LANES]);
        }
    }
}

/// The pusher from `from` to `to` in `h` seconds; `last` is its last direction of translation.
fn motion(from: Pose, to: Pose, h: f64, last: [f64; 2]) -> PusherMotion {
    PusherMotion {
        pose: from,
        twist: from.twist_to(to, h),
        direction: direction(from, to).unwrap_or(last),
    }
}

/// Unit vector of a translation; `None` where there is none.
fn direction(from: Pose, to: Pose) -> Option<[f64; 2]> {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let length = libm::hypot(x, y);
    (length > 0.0).then(|| [x / length, y / length])
}

/// The direction of a pusher's first translation; any where it never moves.
fn first_direction(poses: &[Pose]) -> [f64; 2] {
    let mut pairs = poses.windows(2);
    pairs
        .find_map(|pair| direction(pair[0], pair[1]))
        .unwrap_or([1.0, 0.0])
}
