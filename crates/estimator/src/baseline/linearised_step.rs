//! Γ for a normal distribution of states: [`LinearisedStep`], by differences as wide as the
//! distribution (docs/method.md (47)).

use stickslip_dynamics::{
    Body, Dynamics, Friction, Outcome, Particle, Particles, StepInput, StepWork, Twist,
};
use stickslip_filter::Gaussian;

use crate::baseline::belief::{Belief, FRICTION, STATES, State, StateMatrix};
use crate::particle::set::observer::{Observer, SolvedStep};
use crate::particle::transition::noise_clock::{NOISE_STEP, ROUNDED, sharing};
use crate::particle::transition::propagation::MOVING;
use crate::setup::Setup;

/// Number of states side by side.
const LANES: usize = 8;

/// Number of states of which a step is made: the mean, and one on either side of it along each
/// column of the covariance's root.
const POINTS: usize = 1 + 2 * STATES;

/// Distance of the neighbours from the mean, in standard deviations: √3. With it, the difference
/// over an odd cubic equals the mean slope of the cubic under a normal distribution.
const REACH: f64 = 1.732_050_807_568_877_2;

/// Least share of a variance that is left once the numbers before it are known. Less is rounding.
const LEAST_LEFT: f64 = 1e-12;

/// Γ of one scene, with its state from one step to the next.
pub(super) struct LinearisedStep<'a> {
    setup: &'a Setup,
    dynamics: Dynamics,
    observer: Option<&'a dyn Observer>,
    work: StepWork<LANES>,
    points: [Particles<LANES>; POINTS.div_ceil(LANES)],
    /// Particle of the mean. Its impulses, and how far its pusher yielded, begin the next step of
    /// every point.
    mean: Particle,
    /// Time for which the force has lasted (s).
    lasted: f64,
    /// Events since the row before.
    pub since: Since,
}

/// Events in the steps from a row to the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Since {
    /// Parameters that took part in the mean's steps (Φ, docs/method.md (21)).
    pub took_part: Friction<bool>,
    /// Points with a step that has no certified solution, and those whose solver gave up, one bit
    /// each.
    unsolved: u32,
    failed: u32,
}

impl Since {
    /// The number of points with a step that has no certified solution, and of those whose solver
    /// gave up.
    pub fn counts(&self) -> [u32; 2] {
        [self.unsolved.count_ones(), self.failed.count_ones()]
    }
}

impl<'a> LinearisedStep<'a> {
    pub fn new(setup: &'a Setup, observer: Option<&'a dyn Observer>) -> Self {
        Self {
            setup,
            dynamics: Dynamics::new(setup.scene.clone()),
            observer,
            work: StepWork::default(),
            points: Default::default(),
            mean: Particle::default(),
            lasted: f64::INFINITY,
            since: Since::default(),
        }
    }

    /// Begins the steps to the next row.
    pub fn begin_row(&mut self) {
        self.since = Since::default();
        self.mean.limit_pusher_lag(self.setup.most_pusher_lag());
    }

    /// Advances `belief` by one substep; forces are renewed where they have lasted long enough.
    pub fn advance(&mut self, belief: &mut Belief, input: &StepInput) {
        self.lasted += input.h;
        if self.lasted > NOISE_STEP * (1.0 + ROUNDED) {
            self.lasted = input.h;
            belief.renew_force();
        }
        let root = root(&belief.normal.covariance);
        let moved_before = self.moves();
        self.place_points(belief, &root, input.h);
        let (points, work) = (&mut self.points, &mut self.work);
        self.dynamics.step_block(input, points, work);
        self.mean = self.points[0].get(0);
        self.note(&root, moved_before);
        belief.normal = self.gathered(&belief.normal.mean, root);
    }

    /// Writes the mean and the states on either side of it; the lanes left over repeat the mean.
    fn place_points(&mut self, belief: &Belief, root: &StateMatrix, h: f64) {
        let scene = &self.setup.scene;
        let sharing = f64::from(sharing(h));
        let weight = scene.object.mass * scene.gravity;
        let lasts = (h * sharing / NOISE_STEP).sqrt() * NOISE_STEP;
        let share = self.setup.uncertainty.force_std * weight * lasts / sharing;
        let rho = scene.object.gyration_radius();
        let mean = belief.normal.mean;
        for point in 0..self.points.len() * LANES {
            let state = match column_of(point) {
                Some((column, side)) => mean + root.column(column) * (side * REACH),
                None => mean,
            };
            let (particle, friction) = belief.particle(&state, &self.mean, (share, rho));
            self.points[point / LANES].set(point % LANES, &particle, &friction);
        }
    }

    /// Returns the belief after the step. Its mean is Γ of the mean. A column of its covariance's
    /// root is half of how far the neighbours end apart, in units of [`REACH`].
    fn gathered(&self, mean: &State, root: StateMatrix) -> Gaussian<STATES> {
        let after = |point: usize| -> [f64; FRICTION] {
            let Particle { pose, twist, .. } = self.points[point / LANES].get(point % LANES);
            [pose.x, pose.y, pose.theta, twist.vx, twist.vy, twist.omega]
        };
        let mut mean = *mean;
        for (to, from) in mean.iter_mut().zip(after(0)) {
            *to = from;
        }
        let mut root = root;
        for column in 0..STATES {
            let [ahead, behind] = [after(1 + 2 * column), after(2 + 2 * column)];
            for k in 0..FRICTION {
                root[(k, column)] = (ahead[k] - behind[k]) / (2.0 * REACH);
            }
        }
        Gaussian {
            mean,
            covariance: root * root.transpose(),
        }
    }

    /// Notes what took part in the mean's step, and how those of all points ended.
    fn note(&mut self, root: &StateMatrix, moved_before: bool) {
        let moved = moved_before || self.moves();
        let presses = |body| self.work.normal_impulse(0, body) > 0.0;
        let scene = &self.setup.scene;
        let mut fixels = 0..scene.fixels.len();
        let mut fingers = 0..scene.pusher.fingers.len();
        let took_part = &mut self.since.took_part;
        took_part.mu_s |= moved;
        took_part.d_tri |= moved;
        took_part.mu_p |= fingers.any(|i| presses(Body::Finger(i)));
        took_part.mu_f |= fixels.any(|j| presses(Body::Fixel(j)));
        for point in 0..POINTS {
            // a point that equals the mean is not counted again
            if column_of(point).is_some_and(|(column, _)| root[(column, column)] == 0.0) {
                continue;
            }
            let report = self.work.reports()[point / LANES][point % LANES];
            let bit = 1 << point;
            if report.outcome != Outcome::Solved {
                self.since.unsolved |= bit;
            }
            if report.outcome == Outcome::Failed {
                self.since.failed |= bit;
            }
            if let Some(observer) = self.observer {
                observer.on_step(&SolvedStep {
                    problem: &self.work.problem(point),
                    bodies: &self.work.bodies(point),
                    solution: &self.work.solution(point),
                    report,
                });
            }
        }
    }

    /// Returns true if the mean moves.
    fn moves(&self) -> bool {
        let Twist { vx, vy, omega } = self.mean.twist;
        let turn = omega * self.setup.scene.object.gyration_radius();
        vx * vx + vy * vy + turn * turn > MOVING * MOVING
    }

    /// The mean's contacts after the latest step.
    pub fn work(&self) -> &StepWork<LANES> {
        &self.work
    }
}

/// The column along which a point is displaced, and to which side; `None` for the mean and for
/// lanes past the last point.
fn column_of(point: usize) -> Option<(usize, f64)> {
    let side = if point % 2 == 1 { 1.0 } else { -1.0 };
    (1..POINTS)
        .contains(&point)
        .then(|| ((point - 1) / 2, side))
}

/// Returns the lower triangular L with L Lᵀ = `covariance` (Cholesky). A column is 0 if the numbers
/// before it determine its number.
fn root(covariance: &StateMatrix) -> StateMatrix {
    let mut root = StateMatrix::zeros();
    for j in 0..STATES {
        let product = |root: &StateMatrix, i: usize| {
            (0..j).fold(0.0, |sum, k| sum + root[(i, k)] * root[(j, k)])
        };
        let left = covariance[(j, j)] - product(&root, j);
        if left > LEAST_LEFT * covariance[(j, j)] {
            root[(j, j)] = left.sqrt();
            for i in j + 1..STATES {
                root[(i, j)] = (covariance[(i, j)] - product(&root, i)) / left.sqrt();
            }
        }
    }
    root
}
