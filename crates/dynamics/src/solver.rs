//! The chain of solvers behind one certificate: [`Solver::solve`].
//!
//! The fast Newton iteration answers almost always; a smoothing homotopy, then an exhaustive search over contact modes take what
//! it leaves. Whatever route an answer came by, it counts as solved only where [`Ncp::residual`] says so.

use crate::homotopy::Homotopy;
use crate::lanes::Lanes;
use crate::modes::{Verdict, search};
use crate::ncp::{Impulses, Ncp};
use crate::newton::{NewtonWorkspace, newton};
use crate::polish::Polish;
use crate::problem::{StepProblem, StepSolution};
use crate::rows::{Guess, Rows};

/// Largest natural-map residual of a solved step (m/s).
pub const TOLERANCE: f64 = 1e-9;

/// The iterations aim lower than [`TOLERANCE`], so that rounding does not decide.
const AIM: f64 = 1e-10;

/// Iterations of the fast solver before the next one takes over.
const FAST_ITERATIONS: u32 = 12;

/// Iterations that polish an end point of a slow solver.
const POLISH_ITERATIONS: u32 = 30;

/// Smoothings at which the homotopy takes up cold starts, one after the other: a path may end at a fold, and most folds lie on
/// few paths.
const HOLDING: [f64; 10] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e1, 1e2, 1e-6, 1e-5, 1e-7];

/// Compliance ten times above the one at which the way to the compliant solution begins.
const SOFT: f64 = 10.0;

/// Smoothings tried at each compliance on that way.
const SOFTENING: [f64; 4] = [1.0, 1e-2, 1e2, 1e-4];

/// The same with the pusher yielding at its stall force.
const YIELDING: [f64; 3] = [1e-4, 1.0, 1e-2];

/// Readings of a warm start: its own modes, then everything stuck, as where a jammed or resting object stays.
const WARM_SLIDING: [f64; 2] = [0.9999, f64::INFINITY];

/// Newton steps in the modes of a warm start.
const WARM_POLISH: u32 = 5;

/// Smoothing at which the homotopy takes up a warm start, as a share of the problem's speed scale.
const WARM: f64 = 1e-3;

/// Shares of its bound above which an impulse is taken to slide, tried in turn.
const SLIDING: [f64; 3] = [0.9999, 0.98, 0.8];

/// Compliance κ of the gap rows where no exact solution exists (model.md, "Jamming").
const COMPLIANCE: f64 = 1e-6;

/// How one step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Outcome {
    /// The residual is at most [`TOLERANCE`].
    Solved,
    /// It is proven that no solution exists; the velocity is that of the compliant problem.
    Infeasible,
    /// Neither a solution nor a proof was found; the velocity is that of the compliant problem.
    Failed,
}

/// Which solver the answer came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Semismooth Newton from the warm start.
    Newton,
    /// Smoothing homotopy, polished.
    Homotopy,
    /// Exhaustive search over contact modes.
    Modes,
}

/// What is known of one particle's step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Natural-map residual of the rigid problem (m/s).
    pub residual: f64,
    /// Iterations of the fast solver.
    pub iterations: u32,
    /// Where the answer came from.
    pub route: Route,
}

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
    let mut ncp = Ncp::<1>::empty();
    ncp.assign(std::array::from_ref(problem));
    let mut p = Impulses { v: ncp.free, ..Impulses::zero(problem.contacts.len()) };
    let [report] = Solver::default().solve(&ncp, &mut p);
    (p.to_solution(0, problem), report)
}

/// Solves mixed NCPs; holds the working memory.
#[derive(Clone, Debug)]
pub struct Solver<const W: usize> {
    fast: NewtonWorkspace<W>,
    warm: Impulses<W>,
    slow: SlowSolver,
}

impl<const W: usize> Default for Solver<W> {
    fn default() -> Self {
        Self { fast: NewtonWorkspace::default(), warm: Impulses::zero(0), slow: SlowSolver::default() }
    }
}

impl<const W: usize> Solver<W> {
    /// Solves `ncp` from the impulses in `p` (the warm start; zero is a cold one) and leaves the solution in `p`.
    #[inline(always)]
    pub fn solve(&mut self, ncp: &Ncp<W>, p: &mut Impulses<W>) -> [Report; W] {
        assert_eq!(ncp.contacts.len(), p.normal.len(), "one impulse per contact row");
        self.warm.copy_from(p);
        let (residual, iterations) = newton(ncp, p, &mut self.fast, AIM, FAST_ITERATIONS);
        let mut reports = std::array::from_fn(|lane| Report {
            outcome: Outcome::Solved,
            residual: residual.0[lane],
            iterations: iterations.0[lane] as u32,
            route: Route::Newton,
        });
        for (lane, report) in reports.iter_mut().enumerate() {
            if report.residual > TOLERANCE {
                self.slow.load(ncp, &self.warm, lane);
                self.slow.solve(report);
                p.set_lane(lane, &self.slow.polisher.p);
            }
            rest_exactly(ncp, p, lane, report);
        }
        reports
    }
}

/// A velocity that is zero but for rounding becomes zero where the certificate agrees, so that a stuck object never drifts.
fn rest_exactly<const W: usize>(ncp: &Ncp<W>, p: &mut Impulses<W>, lane: usize, report: &mut Report) {
    let moving = p.v.iter().any(|v| v.0[lane].abs() > TOLERANCE);
    let exact = p.v.iter().all(|v| v.0[lane] == 0.0);
    if moving || exact || report.outcome != Outcome::Solved {
        return;
    }
    let velocity = p.v;
    for v in &mut p.v {
        v.0[lane] = 0.0;
    }
    let residual = ncp.residual(p).0[lane];
    if residual <= TOLERANCE {
        report.residual = residual;
    } else {
        p.v = velocity;
    }
}

/// The slow, sure part of the chain, one particle at a time.
#[derive(Clone, Debug)]
struct SlowSolver {
    ncp: Ncp<1>,
    rows: Rows,
    start: Guess,
    homotopy: Homotopy,
    polisher: Polisher,
}

impl Default for SlowSolver {
    fn default() -> Self {
        Self {
            ncp: Ncp::empty(),
            rows: Rows::default(),
            start: Guess::default(),
            homotopy: Homotopy::default(),
            polisher: Polisher { p: Impulses::zero(0), modes: Polish::default(), fast: NewtonWorkspace::default() },
        }
    }
}

impl SlowSolver {
    /// Takes over one lane of `ncp` and its warm start.
    fn load<const W: usize>(&mut self, ncp: &Ncp<W>, warm: &Impulses<W>, lane: usize) {
        ncp.copy_lane(lane, &mut self.ncp);
        self.rows.assign(&self.ncp);
        self.start.load(warm, lane, self.ncp.contacts.len());
    }

    /// Solves the problem that was loaded; the impulses are in the polisher.
    fn solve(&mut self, report: &mut Report) {
        report.route = Route::Homotopy;
        report.residual = self.polisher.try_modes(&self.ncp, &self.rows, &self.start, &WARM_SLIDING, WARM_POLISH);
        if report.residual > TOLERANCE {
            report.residual = self.follow_from(WARM);
        }
        if report.residual > TOLERANCE {
            report.residual = self.follow();
        }
        if report.residual > TOLERANCE {
            report.route = Route::Modes;
            report.outcome = self.search();
            if report.outcome != Outcome::Solved {
                self.solve_compliant();
            }
            report.residual = self.ncp.residual(&self.polisher.p).0[0];
        }
    }

    /// The homotopy from cold starts, with the pusher holding and with it yielding, until one of the polished ends is certified;
    /// the residual of the last.
    fn follow(&mut self) -> f64 {
        let mut residual = f64::INFINITY;
        let starts = HOLDING.iter().map(|first| (false, first)).chain(YIELDING.iter().map(|first| (true, first)));
        for (yields, &first) in starts {
            self.rows.cold_start(&mut self.start);
            if yields {
                self.rows.yield_start(&mut self.start);
            }
            residual = self.follow_from(first);
            if residual <= TOLERANCE {
                break;
            }
        }
        residual
    }

    /// The homotopy from `self.start` at a share of the speed scale.
    fn follow_from(&mut self, first: f64) -> f64 {
        let end = self.homotopy.follow(&self.rows, &self.start, first);
        self.polisher.polish(&self.ncp, &self.rows, end)
    }

    fn search(&mut self) -> Outcome {
        let (ncp, rows, polisher) = (&self.ncp, &self.rows, &mut self.polisher);
        match search(rows, &mut |guess| polisher.polish(ncp, rows, guess) <= TOLERANCE) {
            Verdict::Solved => Outcome::Solved,
            Verdict::Infeasible => Outcome::Infeasible,
            Verdict::Unresolved => Outcome::Failed,
        }
    }

    /// Leaves the solution with compliant gap rows in the polisher: from soft rows, where it is near the free motion, to stiff ones.
    fn solve_compliant(&mut self) {
        self.rows.cold_start(&mut self.start);
        let mut compliance = SOFT;
        loop {
            compliance = f64::max(0.1 * compliance, COMPLIANCE);
            self.rows.compliance = compliance;
            self.ncp.compliance = Lanes::ZERO + compliance;
            let mut residual = f64::INFINITY;
            for first in SOFTENING {
                residual = self.follow_from(first);
                if residual <= TOLERANCE {
                    break;
                }
            }
            if residual > TOLERANCE {
                self.homotopy.end().store(&mut self.polisher.p);
            }
            self.start.load(&self.polisher.p, 0, self.ncp.contacts.len());
            if compliance <= COMPLIANCE {
                break;
            }
        }
        self.ncp.compliance = Lanes::ZERO;
    }
}

/// Turns a guess into certified impulses, where it is near enough.
#[derive(Clone, Debug)]
struct Polisher {
    p: Impulses<1>,
    modes: Polish,
    fast: NewtonWorkspace<1>,
}

impl Polisher {
    /// Newton in the modes that the guess itself shows; returns the residual.
    fn try_modes(&mut self, ncp: &Ncp<1>, rows: &Rows, guess: &Guess, sliding: &[f64], limit: u32) -> f64 {
        self.p.resize(ncp.contacts.len());
        let mut residual = f64::INFINITY;
        for &share in sliding {
            self.modes.polish(rows, guess, share, limit).store(&mut self.p);
            residual = ncp.residual(&self.p).0[0];
            if residual <= TOLERANCE {
                break;
            }
        }
        residual
    }

    /// Polishes a guess, in its own modes, as it is, and by the fast solver; returns the residual, the impulses are in `self.p`.
    fn polish(&mut self, ncp: &Ncp<1>, rows: &Rows, guess: &Guess) -> f64 {
        let residual = self.try_modes(ncp, rows, guess, &SLIDING, POLISH_ITERATIONS);
        if residual <= TOLERANCE {
            return residual;
        }
        guess.store(&mut self.p);
        newton(ncp, &mut self.p, &mut self.fast, TOLERANCE, POLISH_ITERATIONS).0.0[0]
    }
}
