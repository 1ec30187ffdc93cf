//! Many pushes at once, each over many steps: [`Dynamics::rollout`], and [`Dynamics::rollout_into`]
//! for callers who keep the numbers in arrays of their own.

use crate::friction::Friction;
use crate::input::{FingerMotion, MOST_FINGERS, PusherMotion};
use crate::ncp::report::Outcome;
use crate::particles::{Particle, Particles};
use crate::se2::{Pose, Twist};
use crate::step::Dynamics;
use crate::step_work::StepWork;

/// Trajectories side by side.
const LANES: usize = 8;

/// Chunks of trajectories that make their steps together.
const CHUNKS: usize = 8;

/// Longest step (s); objects on a table stop sooner.
const LONGEST_STEP: f64 = 10.0;

/// Trajectories that make their steps together: who shares a rollout among threads gives each
/// multiples of it.
pub const ROLLOUT_BLOCK: usize = LANES * CHUNKS;

/// Working memory of rollouts, made once.
pub type RolloutWork = StepWork<LANES>;

/// Start of a trajectory, and the friction that governs it.
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
    /// End of each trajectory, (N,).
    pub ends: Vec<RolloutEnd>,
}

/// Result of a trajectory besides its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RolloutEnd {
    /// Steps without a certified solution.
    pub unsolved: u32,
    /// Vector from the first finger's actual position at the end to its pose (m), world frame: the
    /// amount by which it yielded. Zero where it stands at its pose.
    pub pusher_lag: [f64; 2],
    /// Length of the longest such way after any step (m).
    pub most_pusher_lag: f64,
}

/// The arrays of N trajectories as a caller keeps them. Trajectories count from 0 in the order of
/// the starts, rows from 0, the start, to T.
pub trait RolloutArrays {
    /// Pose of a finger of `trajectory` at `row`.
    fn finger(&self, trajectory: usize, row: usize, finger: usize) -> Pose;

    /// Keeps where the object of `trajectory` is at `row`, and how it moves.
    fn keep(&mut self, trajectory: usize, row: usize, pose: Pose, twist: Twist);

    /// Keeps how `trajectory` went.
    fn keep_end(&mut self, trajectory: usize, end: RolloutEnd);
}

/// Reason why a rollout was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RolloutError {
    /// The pushers' poses do not go with the starts.
    #[error(
        "there are {poses} pusher poses for {starts} trajectories; give T + 1 of each trajectory, at least 2, one trajectory after the other; each with one pose per finger, of {fingers}"
    )]
    Shape {
        /// Number of trajectories.
        starts: usize,
        /// Number of pusher poses.
        poses: usize,
        /// Fingers of the scene's pusher.
        fingers: usize,
    },
    /// The step is not positive, or too long.
    #[error("the step is {h} s; it must be above 0 and at most {LONGEST_STEP} s; try 1/30")]
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
    /// Simulates one trajectory per start: T steps of `h` seconds (docs/method.md (11)), driven by
    /// a pusher of its own.
    ///
    /// `pushers` holds the poses of the pusher's fingers where steps begin and end, (N, T + 1,
    /// fingers), trajectory after trajectory: start i under pusher i. The pusher moves straight
    /// from one to the next; where the scene gives it a stall force, it may fall behind, by as much
    /// as the object holds it back. The next step then moves it from where it stands to its next
    /// pose. A trajectory depends on nothing but its start and its pusher, and is the same, bit for
    /// bit, as step by step with [`Dynamics::step`]. One thread runs; share the starts among
    /// threads for more.
    ///
    /// Two starts, and two pushes that end 1 mm and 11 mm beyond the first touch:
    ///
    /// ```
    /// # use stickslip_dynamics::{Dynamics, Feet, Friction, Object, Part, Pose, Pusher, RolloutStart, Scene, Shape, Twist};
    /// # let disc = |radius| Shape::new(vec![Part::Disc { radius, centre: [0.0, 0.0] }]);
    /// # let friction = Friction { mu_s: 0.3, mu_p: 0.3, mu_f: 0.3, d_tri: 0.02 };
    /// # let object = Object { mass: 0.5, inertia: 2e-4, shape: disc(0.03)? };
    /// # let pusher = Pusher { fingers: vec![disc(0.005)?], stall_force: None };
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
        let fingers = self.scene().pusher.fingers.len();
        let rows = pushers.len() / (starts.len().max(1) * fingers);
        if rows * starts.len() * fingers != pushers.len() || (rows < 2 && !starts.is_empty()) {
            return Err(RolloutError::Shape {
                starts: starts.len(),
                poses: pushers.len(),
                fingers,
            });
        }
        let steps = rows.max(1) - 1;
        let mut columns = Columns {
            pushers,
            fingers,
            rollout: Rollout {
                steps,
                poses: vec![Pose::default(); rows * starts.len()],
                twists: vec![Twist::default(); rows * starts.len()],
                ends: vec![RolloutEnd::default(); starts.len()],
            },
        };
        self.rollout_into(h, steps, starts, &mut columns, &mut RolloutWork::default())?;
        Ok(columns.rollout)
    }

    /// Same as [`rollout`](Self::rollout) with T = `steps`, for trajectories in arrays of the
    /// caller's; `work` may be used again.
    ///
    /// # Errors
    /// Where a number is out of range; nothing is kept then.
    pub fn rollout_into(
        &self,
        h: f64,
        steps: usize,
        starts: &[RolloutStart],
        arrays: &mut impl RolloutArrays,
        work: &mut RolloutWork,
    ) -> Result<(), RolloutError> {
        let fingers = self.scene().pusher.fingers.len();
        check(h, steps, starts, (arrays, fingers))?;
        for (block, starts) in starts.chunks(ROLLOUT_BLOCK).enumerate() {
            let mut block = Block {
                first: block * ROLLOUT_BLOCK,
                starts,
                arrays,
            };
            block.simulate(self, h, steps, work);
        }
        Ok(())
    }
}

/// Refuses input that cannot be simulated.
fn check(
    h: f64,
    steps: usize,
    starts: &[RolloutStart],
    (arrays, fingers): (&impl RolloutArrays, usize),
) -> Result<(), RolloutError> {
    if !(h > 0.0 && h <= LONGEST_STEP) {
        return Err(RolloutError::Step { h });
    }
    let not_finite = |what, index, trajectory| {
        Err(RolloutError::NotFinite {
            what,
            index,
            trajectory,
        })
    };
    for (trajectory, start) in starts.iter().enumerate() {
        if !start.is_finite() {
            return not_finite("start", 0, trajectory);
        }
        let is_finite = |row, finger| arrays.finger(trajectory, row, finger).is_finite();
        let bad = (0..=steps).find(|row| (0..fingers).any(|finger| !is_finite(*row, finger)));
        if let Some(row) = bad {
            return not_finite("pusher pose", row, trajectory);
        }
    }
    Ok(())
}

/// Trajectory after trajectory, as [`Dynamics::rollout`] takes and gives them.
struct Columns<'a> {
    pushers: &'a [Pose],
    fingers: usize,
    rollout: Rollout,
}

impl Columns<'_> {
    fn at(&self, trajectory: usize, row: usize) -> usize {
        trajectory * (self.rollout.steps + 1) + row
    }
}

impl RolloutArrays for Columns<'_> {
    fn finger(&self, trajectory: usize, row: usize, finger: usize) -> Pose {
        self.pushers[self.at(trajectory, row) * self.fingers + finger]
    }

    fn keep(&mut self, trajectory: usize, row: usize, pose: Pose, twist: Twist) {
        let at = self.at(trajectory, row);
        self.rollout.poses[at] = pose;
        self.rollout.twists[at] = twist;
    }

    fn keep_end(&mut self, trajectory: usize, end: RolloutEnd) {
        self.rollout.ends[trajectory] = end;
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
struct Block<'a, A> {
    /// The first one.
    first: usize,
    starts: &'a [RolloutStart],
    arrays: &'a mut A,
}

impl<A: RolloutArrays> Block<'_, A> {
    fn simulate(&mut self, dynamics: &Dynamics, h: f64, steps: usize, work: &mut RolloutWork) {
        // lanes past the last trajectory repeat it, without a pusher
        let count = self.starts.len();
        let chunks = count.div_ceil(LANES);
        let mut particles = [Particles::default(); CHUNKS];
        for i in 0..chunks * LANES {
            let start = &self.starts[i.min(count - 1)];
            let particle = Particle {
                pose: start.pose,
                twist: start.twist,
                ..Particle::default()
            };
            particles[i / LANES].set(i % LANES, &particle, &start.friction);
        }
        self.keep(0, &particles);

        let fingers = dynamics.scene().pusher.fingers.len();
        let mut directions = [[[0.0; 2]; MOST_FINGERS]; ROLLOUT_BLOCK];
        for (i, first) in directions[..count].iter_mut().enumerate() {
            for (finger, first) in first[..fingers].iter_mut().enumerate() {
                *first = self.first_direction(i, finger, steps);
            }
        }
        let mut ends = [RolloutEnd::default(); ROLLOUT_BLOCK];
        let mut pushers = [[None; LANES]; CHUNKS];
        for step in 0..steps {
            // the pusher of each trajectory, from where it stands straight to its next pose
            for (i, directions) in directions[..count].iter_mut().enumerate() {
                let lags = particles[i / LANES].pusher_lag;
                let fingers = directions[..fingers].iter_mut().zip(&lags).enumerate();
                let motions = fingers.map(|(finger, (direction, lag))| {
                    let [x, y] = lag.map(|x| x.0[i % LANES]);
                    let Pose {
                        x: from_x,
                        y: from_y,
                        theta,
                    } = self.finger(i, step, finger);
                    let from = Pose::new(from_x - x, from_y - y, theta);
                    let motion = motion(from, self.finger(i, step + 1, finger), h, *direction);
                    *direction = motion.direction;
                    Some(motion)
                });
                pushers[i / LANES][i % LANES] = PusherMotion::new(motions);
            }
            for particles in &mut particles[..chunks] {
                particles.pusher_lag = Default::default();
            }

            dynamics.step_block_each(h, &pushers[..chunks], &mut particles[..chunks], work);

            self.keep(step + 1, &particles);
            let reports = work.reports().as_flattened();
            for (i, (end, report)) in ends[..count].iter_mut().zip(reports).enumerate() {
                end.unsolved += u32::from(report.outcome != Outcome::Solved);
                end.pusher_lag = particles[i / LANES].pusher_lag[0].map(|x| x.0[i % LANES]);
                let [x, y] = end.pusher_lag;
                end.most_pusher_lag = end.most_pusher_lag.max(libm::hypot(x, y));
            }
        }
        for (i, end) in ends[..count].iter().enumerate() {
            self.arrays.keep_end(self.first + i, *end);
        }
    }

    fn finger(&self, i: usize, row: usize, finger: usize) -> Pose {
        self.arrays.finger(self.first + i, row, finger)
    }

    /// Keeps where the object is at row `row` of each trajectory.
    fn keep(&mut self, row: usize, particles: &[Particles<LANES>]) {
        for i in 0..self.starts.len() {
            let particle = &particles[i / LANES];
            let pose = particle.pose.map(|x| x.0[i % LANES]);
            let twist = particle.twist.map(|x| x.0[i % LANES]);
            self.arrays.keep(self.first + i, row, pose, twist);
        }
    }

    /// The direction of a finger's first translation; any where it never moves.
    fn first_direction(&self, i: usize, finger: usize, steps: usize) -> [f64; 2] {
        let at = |row| self.finger(i, row, finger);
        let mut moves = (0..steps).map(|row| (at(row), at(row + 1)));
        moves
            .find_map(|(from, to)| direction(from, to))
            .unwrap_or([1.0, 0.0])
    }
}

/// A finger from `from` to `to` in `h` seconds; `last` is its last direction of translation.
fn motion(from: Pose, to: Pose, h: f64, last: [f64; 2]) -> FingerMotion {
    FingerMotion {
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
