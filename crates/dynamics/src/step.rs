//! One time step Γ, and Γ' with noise (eq. 3 and 6), for `W` particles side by side: [`Dynamics::step`].
//!
//! Gaps are taken at the poses at the start of the step; the mixed NCP gives the twist at its end; q⁺ = q + h v⁺.

use crate::impulses::Impulses;
use crate::lanes::Lanes;
use crate::narrow::{Gap, Placed, narrow_phase};
use crate::ncp::Ncp;
use crate::problem::{ContactPoint, Foot, Stall, StepProblem, StepSolution};
use crate::scene::{Feet, Friction, Scene};
use crate::solver::{Report, Solver};
use crate::{Pose, Twist, Wrench};

/// Added to the distance that bodies can close within one step when contacts are sought (m).
const MARGIN: f64 = 5e-4;

/// Contacts whose impulses a particle remembers for its next step.
const REMEMBERED: usize = 4;

/// The pusher during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PusherMotion {
    /// Pose at the start of the step.
    pub pose: Pose,
    /// Commanded twist during the step.
    pub twist: Twist,
    /// Unit vector of its commanded translation (the last one where it stands): the direction in which it may give way.
    pub direction: [f64; 2],
}

/// What drives one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput {
    /// Step (s).
    pub h: f64,
    /// The pusher; `None` while it is off the plane.
    pub pusher: Option<PusherMotion>,
}

/// State of one particle, and the impulse that is applied to it in the coming step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Particle {
    /// Pose of the object.
    pub pose: Pose,
    /// Twist of the object.
    pub twist: Twist,
    /// Applied impulse p_app + w_app (N s, N s, N m s).
    pub applied: Wrench,
    /// Impulses of the step before.
    pub warm: WarmStart,
}

/// Impulses of a step, mass-normalised, from which the next one starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmStart {
    /// Per foot (m/s).
    pub feet: [[f64; 2]; 3],
    /// Speed by which the pusher gave way (m/s).
    pub pusher_yield: f64,
    /// Per remembered contact: its key (body and place among the body's contacts; 0: no contact), p_n, p_t (m/s).
    pub contacts: [[f64; 3]; REMEMBERED],
}

impl WarmStart {
    /// Numbers in [`WarmStart::to_array`].
    pub const LEN: usize = 7 + 3 * REMEMBERED;

    /// As plain numbers, to be stored in columns.
    pub fn to_array(&self) -> [f64; Self::LEN] {
        let mut array = [0.0; Self::LEN];
        array[..6].copy_from_slice(self.feet.as_flattened());
        array[6] = self.pusher_yield;
        array[7..].copy_from_slice(self.contacts.as_flattened());
        array
    }

    /// The inverse of [`WarmStart::to_array`].
    pub fn from_array(array: &[f64; Self::LEN]) -> Self {
        let mut warm = Self { pusher_yield: array[6], ..Self::default() };
        warm.feet.as_flattened_mut().copy_from_slice(&array[..6]);
        warm.contacts.as_flattened_mut().copy_from_slice(&array[7..]);
        warm
    }
}

/// A body that the object may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The pusher.
    Pusher,
    /// The fixel of this index.
    Fixel(usize),
}

/// Contacts of one body that keys tell apart.
const PLACES: usize = 64;

/// What names a contact from one step to the next: its body, and its place among that body's contacts.
fn contact_keys(bodies: &[Body]) -> impl Iterator<Item = f64> + '_ {
    let mut place = 0;
    bodies.iter().enumerate().map(move |(row, body)| {
        place = if row > 0 && bodies[row - 1] == *body { place + 1 } else { 0 };
        let number = match body {
            Body::Pusher => 1,
            Body::Fixel(j) => 2 + j,
        };
        (number * PLACES + place) as f64
    })
}

/// Γ for one scene.
#[derive(Clone, Debug)]
pub struct Dynamics {
    scene: Scene,
    reach: f64,
}

/// Working memory of [`Dynamics::step`] for `W` particles; nothing is allocated once it has grown.
#[derive(Clone, Debug)]
pub struct StepWork<const W: usize> {
    gaps: Vec<Gap>,
    problems: [StepProblem; W],
    bodies: [Vec<Body>; W],
    ncp: Ncp<W>,
    impulses: Impulses<W>,
    solver: Solver<W>,
}

impl<const W: usize> Default for StepWork<W> {
    fn default() -> Self {
        Self {
            gaps: Vec::new(),
            problems: std::array::from_fn(|_| StepProblem::default()),
            bodies: std::array::from_fn(|_| Vec::new()),
            ncp: Ncp::empty(),
            impulses: Impulses::zero(0),
            solver: Solver::default(),
        }
    }
}

impl<const W: usize> StepWork<W> {
    /// Normal impulse (N s) between the object and a body in the last step, summed over their contacts.
    pub fn normal_impulse(&self, lane: usize, body: Body) -> f64 {
        let rows = self.bodies[lane].iter().zip(&self.impulses.normal);
        rows.filter(|(b, _)| **b == body).map(|(_, p)| p.0[lane]).sum::<f64>() * self.problems[lane].mass
    }

    /// The last step's problem of one lane.
    pub fn problem(&self, lane: usize) -> &StepProblem {
        &self.problems[lane]
    }

    /// The last step's solution of one lane.
    pub fn solution(&self, lane: usize) -> StepSolution {
        self.impulses.to_solution(lane, &self.problems[lane])
    }

    fn assign_warm_starts(&mut self, particles: &[Particle; W], gyration_radius: f64) {
        let rows = self.ncp.contacts.len();
        self.impulses.normal.clear();
        self.impulses.tangential.clear();
        self.impulses.resize(rows);
        for (lane, particle) in particles.iter().enumerate() {
            let Twist { vx, vy, omega } = particle.twist;
            for (v, value) in self.impulses.v.iter_mut().zip([vx, vy, gyration_radius * omega]) {
                v.0[lane] = value;
            }
            self.impulses.pusher_yield.0[lane] = particle.warm.pusher_yield;
            for k in 0..3 {
                self.impulses.feet[k][0].0[lane] = particle.warm.feet[k][0];
                self.impulses.feet[k][1].0[lane] = particle.warm.feet[k][1];
            }
            for (row, key) in contact_keys(&self.bodies[lane]).enumerate() {
                if let Some([_, normal, tangential]) = particle.warm.contacts.iter().find(|slot| slot[0] == key) {
                    self.impulses.normal[row].0[lane] = *normal;
                    self.impulses.tangential[row].0[lane] = *tangential;
                }
            }
        }
    }

    fn warm_start(&self, lane: usize) -> WarmStart {
        let mut warm = WarmStart {
            feet: self.impulses.feet.map(|p| p.map(|x| x.0[lane])),
            pusher_yield: self.impulses.pusher_yield.0[lane],
            ..WarmStart::default()
        };
        let pressed = contact_keys(&self.bodies[lane]).enumerate().filter(|(row, _)| self.impulses.normal[*row].0[lane] > 0.0);
        for (slot, (row, key)) in warm.contacts.iter_mut().zip(pressed) {
            *slot = [key, self.impulses.normal[row].0[lane], self.impulses.tangential[row].0[lane]];
        }
        warm
    }
}

impl Dynamics {
    /// The dynamics of one scene.
    pub fn new(scene: Scene) -> Self {
        Self { reach: scene.object.shape.bounding_radius(), scene }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Advances `W` particles by one step; `friction` holds each one's parameters.
    ///
    /// Every contact that could act takes part: where the solved twist could have closed a larger gap than was looked for,
    /// the step is solved again with a wider search.
    pub fn step<const W: usize>(
        &self,
        input: &StepInput,
        friction: &[Friction; W],
        particles: &mut [Particle; W],
        work: &mut StepWork<W>,
    ) -> [Report; W] {
        let mut search: [f64; W] = std::array::from_fn(|lane| self.search_distance(input, &particles[lane]));
        loop {
            for lane in 0..W {
                self.collect(input, &friction[lane], &particles[lane], search[lane], &mut Lane::of(work, lane));
            }
            work.ncp.assign(&work.problems);
            work.assign_warm_starts(particles, self.scene.object.gyration_radius());
            let mut reports = [[Report::UNSOLVED; W]];
            work.solver.solve(std::slice::from_ref(&work.ncp), std::slice::from_mut(&mut work.impulses), &mut reports);
            let [reports] = reports;
            if !self.widen(input, work, &mut search) {
                self.integrate(input.h, particles, work);
                return reports;
            }
        }
    }

    /// Widens the search of lanes whose solution moves farther than it covered; true where there is such a lane.
    fn widen<const W: usize>(&self, input: &StepInput, work: &StepWork<W>, search: &mut [f64; W]) -> bool {
        let mut wider = false;
        for (lane, distance) in search.iter_mut().enumerate() {
            let needed = input.h * (self.point_speed(&work.twist(lane, self.scene.object.gyration_radius())) + self.pusher_speed(input));
            if needed > *distance && needed.is_finite() && *distance < 1e3 {
                *distance = 2.0 * needed;
                wider = true;
            }
        }
        wider
    }

    fn integrate<const W: usize>(&self, h: f64, particles: &mut [Particle; W], work: &StepWork<W>) {
        let rho = self.scene.object.gyration_radius();
        for (lane, particle) in particles.iter_mut().enumerate() {
            particle.twist = work.twist(lane, rho);
            particle.pose = particle.pose.advance(particle.twist, h);
            particle.warm = work.warm_start(lane);
        }
    }

    /// Fastest point of the object.
    fn point_speed(&self, twist: &Twist) -> f64 {
        twist.vx.hypot(twist.vy) + twist.omega.abs() * self.reach
    }

    /// Fastest point of the pusher.
    fn pusher_speed(&self, input: &StepInput) -> f64 {
        let radius = self.scene.pusher.shape.bounding_radius();
        input.pusher.map_or(0.0, |p| p.twist.vx.hypot(p.twist.vy) + p.twist.omega.abs() * radius)
    }

    fn search_distance(&self, input: &StepInput, particle: &Particle) -> f64 {
        let object = &self.scene.object;
        let kick =
            particle.applied.fx.hypot(particle.applied.fy) / object.mass + particle.applied.torque.abs() / object.inertia * self.reach;
        let pusher = self.pusher_speed(input);
        input.h * (1.5 * (self.point_speed(&particle.twist) + kick).max(pusher) + pusher) + MARGIN
    }

    /// Writes the step's problem of one particle.
    fn collect(&self, input: &StepInput, friction: &Friction, particle: &Particle, search: f64, lane: &mut Lane<'_>) {
        let scene = &self.scene;
        let placed = Placed::new(&scene.object.shape, particle.pose);
        lane.problem.mass = scene.object.mass;
        lane.problem.inertia = scene.object.inertia;
        lane.problem.h = input.h;
        lane.problem.twist = particle.twist;
        lane.problem.applied = particle.applied;
        lane.problem.feet = scene.feet_at(particle.pose.theta, friction, input.h);
        lane.problem.stall = None;
        lane.problem.contacts.clear();
        lane.bodies.clear();
        if let Some(pusher) = &input.pusher {
            let limit = scene.pusher.stall_force;
            lane.problem.stall = limit.map(|force| Stall { impulse: force * input.h, direction: pusher.direction });
            let other = Placed::new(&scene.pusher.shape, pusher.pose);
            lane.add(Body::Pusher, friction.mu_p, search, (&placed, &other), |arm| {
                let [x, y] = [particle.pose.x + arm[0] - pusher.pose.x, particle.pose.y + arm[1] - pusher.pose.y];
                pusher.twist.at([x, y])
            });
        }
        for (j, fixel) in scene.fixels.iter().enumerate() {
            let other = Placed::new(&fixel.shape, fixel.pose);
            lane.add(Body::Fixel(j), friction.mu_f, search, (&placed, &other), |_| [0.0; 2]);
        }
    }
}

impl<const W: usize> StepWork<W> {
    /// Solved twist of one lane.
    fn twist(&self, lane: usize, gyration_radius: f64) -> Twist {
        let [vx, vy, scaled]: [Lanes<W>; 3] = self.impulses.v;
        Twist { vx: vx.0[lane], vy: vy.0[lane], omega: scaled.0[lane] / gyration_radius }
    }
}

/// One lane's part of the working memory.
struct Lane<'a> {
    gaps: &'a mut Vec<Gap>,
    problem: &'a mut StepProblem,
    bodies: &'a mut Vec<Body>,
}

impl<'a> Lane<'a> {
    fn of<const W: usize>(work: &'a mut StepWork<W>, lane: usize) -> Self {
        Self { gaps: &mut work.gaps, problem: &mut work.problems[lane], bodies: &mut work.bodies[lane] }
    }

    /// Adds the contacts of the object with one body whose surface moves with `velocity` at an arm from the object's centre.
    fn add(&mut self, body: Body, mu: f64, search: f64, pair: (&Placed<'_>, &Placed<'_>), velocity: impl Fn([f64; 2]) -> [f64; 2]) {
        self.gaps.clear();
        narrow_phase(pair.0, pair.1, search, self.gaps);
        for gap in self.gaps.iter() {
            self.bodies.push(body);
            self.problem.contacts.push(ContactPoint {
                normal: gap.normal,
                arm: gap.arm,
                gap: gap.gap,
                mu,
                surface_velocity: velocity(gap.arm),
                on_pusher: body == Body::Pusher,
            });
        }
    }
}

impl Scene {
    /// The feet of an object at angle `theta`: arms in the world frame, friction bounds for a step of `h` seconds.
    pub fn feet_at(&self, theta: f64, friction: &Friction, h: f64) -> [Foot; 3] {
        let total = friction.mu_s * self.object.mass * self.gravity * h;
        match self.feet {
            Feet::Tripod { angle } => {
                let (sin, cos) = libm::sincos(theta + angle);
                let half_root3 = 0.75f64.sqrt();
                let turns = [(1.0, 0.0), (-0.5, half_root3), (-0.5, -half_root3)];
                turns.map(|(c, s)| Foot {
                    arm: [friction.d_tri * (c * cos - s * sin), friction.d_tri * (c * sin + s * cos)],
                    bound: total / 3.0,
                })
            }
            Feet::Known { positions, loads } => {
                let (sin, cos) = libm::sincos(theta);
                std::array::from_fn(|k| {
                    let [x, y] = positions[k];
                    Foot { arm: [cos * x - sin * y, sin * x + cos * y], bound: total * loads[k] }
                })
            }
        }
    }
}
