//! The chain of solvers behind one certificate: [`Solver::solve`].
//!
//! The semismooth Newton iteration answers almost always. What it leaves of a whole block of
//! particles goes to the smoothed Newton steps, packed together, still side by side; a smoothing
//! homotopy, then an exhaustive search over contact modes take what is left, one by one. Whatever
//! route an answer came by, it counts as solved only where [`Ncp::residual`] says so.

use stickslip_lanes::Lanes;

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::report::{Outcome, Report, Route, TOLERANCE};
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;
use crate::solver::fallback::SlowSolver;
use crate::solver::lane_queue::Place;
use crate::solver::newton::{Goal, NEAR};
use crate::solver::newton_block::{FastSolver, Iterated};
use crate::solver::smoothed_path::{Block, Continuation, Descent, End};
use crate::solver::source::Source;

/// What the fast solver tries: a residual below [`TOLERANCE`], which counts in the end, for the
/// impulses of feet that slip slowly.
const FAST: Goal = Goal {
    residual: 1e-10,
    iterations: 32,
    weight: NEAR,
};

/// Ways down from a warm start that the smoothed steps try one after the other: from next to it,
/// from afar, and slowly.
const DESCENTS: [Descent; 3] = [
    Descent {
        start: 1e-7,
        reduction: 0.01,
        near: 1e6,
        sliding: 0.9999,
    },
    Descent {
        start: 1e-1,
        reduction: 0.01,
        near: 1e3,
        sliding: 0.9999,
    },
    Descent {
        start: 1e-3,
        reduction: 0.1,
        near: 10.0,
        sliding: 0.9999,
    },
];

/// Solves one step's problem from a cold start.
///
/// ```
/// # use stickslip_dynamics::{Foot, Outcome, StepProblem, Twist, solve};
/// // a block that slides at 1 m/s on three frictionless feet keeps its speed
/// let twist = Twist { vx: 1.0, ..Twist::default() };
/// let problem = StepProblem { mass: 1.0, inertia: 1.0, h: 0.01, twist, ..StepProblem::default() };
/// let (solution, report) = solve(&problem);
/// assert_eq!((report.outcome, solution.twist), (Outcome::Solved, twist));
/// ```
pub fn solve(problem: &StepProblem) -> (StepSolution, Report) {
    let (mut ncps, mut p, mut reports) =
        ([Ncp::empty()], [Impulses::zero(0)], [[Report::UNSOLVED]]);
    Solver::default().solve(&mut Cold(problem), &mut ncps, &mut p, &mut reports);
    let ([p], [[report]]) = (p, reports);
    (p.to_solution(0, problem), report)
}

/// A single problem without a warm start.
struct Cold<'a>(&'a StepProblem);

impl Source<1> for Cold<'_> {
    fn load(&mut self, _: usize, ncp: &mut Ncp<1>) {
        ncp.assign(std::array::from_ref(self.0));
    }

    fn start(&self, _: usize, ncp: &Ncp<1>, p: &mut Impulses<1>) {
        p.cold_start(ncp);
    }
}

/// Solves mixed NCPs; holds the working memory.
#[derive(Clone, Debug)]
pub struct Solver<const W: usize> {
    fast: FastSolver<W>,
    map: NaturalMap<W>,
    warm: Vec<Impulses<W>>,
    left: Vec<Place>,
    kept: Vec<Place>,
    continuation: Continuation<W>,
    slow: SlowSolver,
}

impl<const W: usize> Default for Solver<W> {
    fn default() -> Self {
        Self {
            fast: FastSolver::default(),
            map: NaturalMap::default(),
            warm: Vec::new(),
            left: Vec::new(),
            kept: Vec::new(),
            continuation: Continuation::default(),
            slow: SlowSolver::default(),
        }
    }
}

impl<const W: usize> Solver<W> {
    /// Solves the block of problems that comes from `source`, `W` to a chunk; leaves the problems
    /// in `ncps`, their solutions in `p`.
    #[inline(always)]
    pub fn solve(
        &mut self,
        source: &mut impl Source<W>,
        ncps: &mut [Ncp<W>],
        p: &mut [Impulses<W>],
        reports: &mut [[Report; W]],
    ) {
        assert!(
            ncps.len() == p.len() && p.len() == reports.len(),
            "as many chunks of impulses and reports as of problems"
        );
        self.warm
            .resize_with(ncps.len().max(self.warm.len()), || Impulses::zero(0));
        for places in [&mut self.left, &mut self.kept] {
            places.clear();
            // as many as can be left: how many there are changes from step to step, and no step
            // after the first may allocate
            places.reserve(W * ncps.len());
        }
        let left = &mut self.left;
        self.fast.solve(
            source,
            ncps,
            p,
            FAST,
            &mut |Iterated {
                      place,
                      residual,
                      iterations,
                  }| {
                reports[place.chunk][place.lane] = Report {
                    outcome: Outcome::Solved,
                    residual,
                    iterations,
                    route: Route::Newton,
                };
                if residual > TOLERANCE {
                    left.push(place);
                }
            },
        );
        if !self.left.is_empty() {
            self.solve_left(source, ncps, p, reports);
        }
        for ((ncp, p), reports) in ncps.iter().zip(p).zip(reports) {
            rest_exactly(ncp, p, &mut self.map, reports);
        }
    }

    /// The problems that the fast solver left, packed together; then one by one what is left of
    /// them.
    #[inline(always)]
    fn solve_left(
        &mut self,
        source: &impl Source<W>,
        ncps: &[Ncp<W>],
        p: &mut [Impulses<W>],
        reports: &mut [[Report; W]],
    ) {
        for &Place { chunk, .. } in &self.left {
            source.start(chunk, &ncps[chunk], &mut self.warm[chunk]);
        }
        let block = Block {
            ncps,
            warm: &self.warm,
        };
        for descent in &DESCENTS {
            self.kept.clear();
            let mut finish = |end: &End<'_, W>| {
                let place = self.left[end.task];
                let report = &mut reports[place.chunk][place.lane];
                report.route = Route::Continuation;
                report.iterations += end.steps;
                report.residual = end.residual;
                if end.residual <= TOLERANCE {
                    p[place.chunk].unpack_lane(
                        &ncps[place.chunk],
                        place.lane,
                        end.impulses,
                        end.lane,
                    );
                } else {
                    self.kept.push(place);
                }
            };
            self.continuation
                .solve(block, &self.left, descent, TOLERANCE, &mut finish);
            std::mem::swap(&mut self.left, &mut self.kept);
        }
        for &Place { chunk, lane } in &self.left {
            let solution = self.slow.solve(
                &ncps[chunk],
                &self.warm[chunk],
                lane,
                &mut reports[chunk][lane],
            );
            p[chunk].unpack_lane(&ncps[chunk], lane, solution, 0);
        }
    }
}

/// A velocity that is zero but for rounding becomes zero where the certificate agrees, so that a
/// stuck object never drifts.
#[inline(always)]
fn rest_exactly<const W: usize>(
    ncp: &Ncp<W>,
    p: &mut Impulses<W>,
    map: &mut NaturalMap<W>,
    reports: &mut [Report; W],
) {
    let mut fastest = Lanes::ZERO;
    for v in &p.v {
        fastest = fastest.max(v.abs());
    }
    let nearly = fastest.gt(Lanes::ZERO) & !fastest.gt(Lanes::splat(TOLERANCE));
    if !nearly.any() {
        return;
    }
    let velocity = p.v;
    for v in &mut p.v {
        *v = nearly.select(Lanes::ZERO, *v);
    }
    let residual = map.take(ncp, p);
    let mut exact = nearly & !residual.gt(Lanes::splat(TOLERANCE));
    for (lane, report) in reports.iter_mut().enumerate() {
        exact.set(lane, exact.lane(lane) && report.outcome == Outcome::Solved);
        if exact.lane(lane) {
            report.residual = residual.0[lane];
        }
    }
    for (v, moving) in p.v.iter_mut().zip(velocity) {
        *v = exact.select(Lanes::ZERO, moving);
    }
}
