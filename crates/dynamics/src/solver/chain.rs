//! The chain of solvers behind one certificate: [`Solver::solve`].
//!
//! The semismooth Newton iteration answers almost always. The particles of a whole block that it
//! leaves unsolved are packed together, and follow a path of smoothed solutions side by side: first
//! from their warm start, then from their free motion. A search over contact modes then takes the
//! rest one by one. Whatever route an answer came by, it counts as solved only where
//! [`Ncp::certifies`] says so.

use stickslip_lanes::{Lanes, Level, on_fused, on_lanes};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::problem::{StepProblem, StepSolution};
use crate::ncp::report::{Outcome, Report, Route, TOLERANCE};
use crate::ncp::rows::{LEAST_SPEED_LIMIT, Ncp};
use crate::ncp::unknowns::Unknowns;
use crate::solver::fallback::{Fallback, WorkLimit};
use crate::solver::lane_queue::LaneIndex;
use crate::solver::newton::NewtonSettings;
use crate::solver::newton_block::NewtonBlock;
use crate::solver::smoothed_path::{BOLD, CAREFUL, SmoothedPath, StartedBlock};
use crate::solver::source::Source;
use crate::solver::stick_predictor::SLIP_WEIGHT_NEAR;

/// Of the first solver. It aims below [`TOLERANCE`], which decides in the end, for the sake of the
/// impulses of feet that slip slowly.
pub(crate) const NEWTON: NewtonSettings = NewtonSettings {
    tolerance: 1e-10,
    iterations: 32,
    slip_weight: SLIP_WEIGHT_NEAR,
};

/// Of a step of a block: the longest takes one to two milliseconds. Jams at the edge of having a
/// solution, whose contacts close together, take most: of 6.6 million steps in 1100 random scenes
/// four failed with 3000 systems, 24 with 2000; of 305 million two with 5000, one with 6000.
pub(crate) const STEP_LIMIT: WorkLimit = WorkLimit {
    search: 6_000,
    compliant: 300,
};

/// Of a problem that is solved for its own sake.
const NO_HURRY: WorkLimit = WorkLimit {
    search: 10_000_000,
    compliant: 100_000,
};

/// Solves one step's problem from a cold start, however long it takes.
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
    solve_alone(&mut Alone {
        problem,
        start: None,
    })
}

/// [`solve`] from `start`, such as the solution of the step before, on the same contacts.
///
/// # Panics
/// If it has not one impulse per contact.
pub fn solve_from(problem: &StepProblem, start: &StepSolution) -> (StepSolution, Report) {
    solve_alone(&mut Alone {
        problem,
        start: Some(start),
    })
}

fn solve_alone(alone: &mut Alone<'_>) -> (StepSolution, Report) {
    let (mut ncps, mut z, mut reports) = (
        [Ncp::default()],
        [Unknowns::default()],
        [[Report::UNSOLVED]],
    );
    let mut solver = Solver::with_limit(NO_HURRY);
    let level = Level::new();
    on_fused(
        level,
        #[inline(always)]
        || solver.solve(level, alone, &mut ncps, &mut z, &mut reports),
    );
    let ([z], [[report]]) = (z, reports);
    (z.to_solution(0, alone.problem), report)
}

/// A single problem, and where its solver starts; without that at the free motion.
struct Alone<'a> {
    problem: &'a StepProblem,
    start: Option<&'a StepSolution>,
}

impl Source<1> for Alone<'_> {
    fn load(&mut self, _: usize, ncp: &mut Ncp<1>) {
        ncp.assign(std::array::from_ref(self.problem));
    }

    fn start(&self, _: usize, ncp: &Ncp<1>, z: &mut Unknowns<1>) {
        match self.start {
            Some(start) => z.assign(start, self.problem),
            None => z.cold_start(ncp),
        }
    }
}

/// Solves mixed NCPs; holds the working memory.
#[derive(Clone, Debug)]
pub struct Solver<const W: usize> {
    newton: NewtonBlock<W>,
    path: SmoothedPath<W>,
    fallback: Fallback,
    limit: WorkLimit,
    map: NaturalMap<W>,
    start: Vec<Unknowns<W>>,
    unsolved: Vec<LaneIndex>,
    still_unsolved: Vec<LaneIndex>,
}

impl<const W: usize> Default for Solver<W> {
    /// For the steps of a block, each with a limit on work.
    fn default() -> Self {
        Self::with_limit(STEP_LIMIT)
    }
}

impl<const W: usize> Solver<W> {
    fn with_limit(limit: WorkLimit) -> Self {
        Self {
            newton: NewtonBlock::default(),
            path: SmoothedPath::default(),
            fallback: Fallback::default(),
            limit,
            map: NaturalMap::default(),
            start: Vec::new(),
            unsolved: Vec::new(),
            still_unsolved: Vec::new(),
        }
    }

    /// Solves the block of problems that comes from `source`, `W` to a chunk; leaves the problems
    /// in `ncps`, their solutions in `z`. `level` is that of the caller's instructions.
    #[inline(always)]
    pub fn solve(
        &mut self,
        level: Level,
        source: &mut impl Source<W>,
        ncps: &mut [Ncp<W>],
        z: &mut [Unknowns<W>],
        reports: &mut [[Report; W]],
    ) {
        assert!(
            ncps.len() == z.len() && z.len() == reports.len(),
            "as many chunks of unknowns and reports as of problems"
        );
        self.reserve(ncps.len());
        // all problems by the Newton iteration
        let (unsolved, asked) = (&mut self.unsolved, source.asked());
        self.newton.solve(source, ncps, z, NEWTON, &mut |end| {
            let report = &mut reports[end.index.chunk][end.index.lane];
            if !asked.lane(end.index.lane) {
                *report = Report::UNSOLVED;
                return;
            }
            *report = Report {
                outcome: Outcome::Solved,
                residual: end.residual,
                systems: end.iterations,
                route: Route::Newton,
            };
            if end.residual > TOLERANCE {
                unsolved.push(end.index);
            }
        });
        self.reject_fast(ncps, z, reports);
        // what it leaves over
        if !self.unsolved.is_empty() {
            self.solve_unsolved(level, source, ncps, z, reports);
        }
        for ((ncp, z), reports) in ncps.iter().zip(z).zip(reports) {
            rest_exactly(ncp, z, &mut self.map, reports);
            if !z.is_bounded().all() {
                self.fallback.relieve_lanes(ncp, z, reports);
            }
        }
    }

    /// Makes room for as many unsolved problems as there can be: their number changes from step to
    /// step, and no step after the first may allocate.
    #[inline(always)]
    fn reserve(&mut self, chunks: usize) {
        self.start
            .resize_with(chunks.max(self.start.len()), Unknowns::default);
        for indices in [&mut self.unsolved, &mut self.still_unsolved] {
            indices.clear();
            indices.reserve(W * chunks);
        }
    }

    /// Takes back solutions that are faster than any is sought.
    #[inline(always)]
    fn reject_fast(&mut self, ncps: &[Ncp<W>], z: &[Unknowns<W>], reports: &[[Report; W]]) {
        for (chunk, ((ncp, z), reports)) in ncps.iter().zip(z).zip(reports).enumerate() {
            // the limit is looked up for few
            let fastest = z.fastest();
            let mut fast = fastest.gt(Lanes::splat(LEAST_SPEED_LIMIT));
            if !fast.any() {
                continue;
            }
            fast = fast & fastest.gt(ncp.speed_limit());
            for lane in fast.lanes() {
                let Report {
                    outcome, residual, ..
                } = reports[lane];
                if outcome == Outcome::Solved && residual <= TOLERANCE {
                    self.unsolved.push(LaneIndex { chunk, lane });
                }
            }
        }
    }

    /// The unsolved problems: along the path, then one by one.
    ///
    /// Compiled apart from the Newton iteration: in one larger piece of code the compiler would
    /// call functions that it should inline.
    #[inline(never)]
    fn solve_unsolved(
        &mut self,
        level: Level,
        source: &impl Source<W>,
        ncps: &mut [Ncp<W>],
        z: &mut [Unknowns<W>],
        reports: &mut [[Report; W]],
    ) {
        // where it returns `None`, steps of eight particles are not compiled either
        let _ = on_lanes::<W, ()>(
            level,
            #[inline(always)]
            || self.follow_paths(source, ncps, z, reports),
        );
        // search over modes, compliant problem
        for &LaneIndex { chunk, lane } in &self.unsolved {
            let (ncp, report) = (&ncps[chunk], &mut reports[chunk][lane]);
            let solution = self.fallback.solve(ncp, lane, self.limit, report);
            z[chunk].unpack_lane(ncp, lane, solution, 0);
        }
    }

    /// The unsolved problems, packed together, from their warm starts; then those that are left
    /// from the free motion, since the last step's impulses may have led them astray.
    #[inline(always)]
    fn follow_paths(
        &mut self,
        source: &impl Source<W>,
        ncps: &[Ncp<W>],
        z: &mut [Unknowns<W>],
        reports: &mut [[Report; W]],
    ) {
        // in a loop, so that the path is compiled once
        for (schedule, warm) in [(&BOLD, true), (&CAREFUL, false)] {
            for &LaneIndex { chunk, .. } in &self.unsolved {
                let (ncp, start) = (&ncps[chunk], &mut self.start[chunk]);
                if warm {
                    source.start(chunk, ncp, start);
                } else {
                    start.cold_start(ncp);
                }
            }
            self.still_unsolved.clear();
            let block = StartedBlock {
                ncps,
                start: &self.start,
            };
            let still_unsolved = &mut self.still_unsolved;
            self.path
                .solve(block, &self.unsolved, schedule, TOLERANCE, &mut |end| {
                    let LaneIndex { chunk, lane } = end.index;
                    let report = &mut reports[chunk][lane];
                    report.route = Route::SmoothedPath;
                    report.systems += end.steps;
                    report.residual = end.residual;
                    let limit = ncps[chunk].speed_limit().0[lane];
                    if end.residual <= TOLERANCE && end.z.fastest().0[end.slot] <= limit {
                        z[chunk].unpack_lane(&ncps[chunk], lane, end.z, end.slot);
                    } else {
                        still_unsolved.push(end.index);
                    }
                });
            std::mem::swap(&mut self.unsolved, &mut self.still_unsolved);
        }
    }
}

/// Sets velocities to zero that are zero but for rounding, where the certificate agrees, so that a
/// stuck object never drifts.
#[inline(always)]
fn rest_exactly<const W: usize>(
    ncp: &Ncp<W>,
    z: &mut Unknowns<W>,
    map: &mut NaturalMap<W>,
    reports: &mut [Report; W],
) {
    // lanes that nearly rest
    let mut fastest = Lanes::ZERO;
    for v in &z.v {
        fastest = fastest.max(v.abs());
    }
    let nearly = fastest.gt(Lanes::ZERO) & !fastest.gt(Lanes::splat(TOLERANCE));
    if !nearly.any() {
        return;
    }
    // their residual at rest
    let velocity = z.v;
    for v in &mut z.v {
        *v = nearly.select(Lanes::ZERO, *v);
    }
    let residual = map.evaluate(ncp, z);
    let mut exact = nearly & !residual.gt(Lanes::splat(TOLERANCE));
    for (lane, report) in reports.iter_mut().enumerate() {
        exact.set(lane, exact.lane(lane) && report.outcome == Outcome::Solved);
        if exact.lane(lane) {
            report.residual = residual.0[lane];
        }
    }
    // the others go on as they were
    for (v, moving) in z.v.iter_mut().zip(velocity) {
        *v = exact.select(Lanes::ZERO, moving);
    }
}
