//! What the solvers in lanes leave over, one particle at a time: [`Fallback`].

use stickslip_lanes::Lanes;

use crate::ncp::report::{Outcome, Report, Route, TOLERANCE};
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::homotopy::Homotopy;
use crate::solver::mode_search::{Verdict, search};
use crate::solver::refiner::Refiner;
use crate::solver::scalar_ncp::{Candidate, ScalarNcp};

/// Shares of its bound above which an impulse of the warm start is taken to slide: its own modes,
/// then everything stuck, as where a jammed or resting object stays.
const WARM_SLIDING: [f64; 2] = [0.9999, f64::INFINITY];

/// Newton steps in the modes of a warm start.
const WARM_ITERATIONS: u32 = 5;

/// Smoothing with which the homotopy begins at a warm start, as a share of the problem's speed
/// scale.
const WARM_SMOOTHING: f64 = 1e-3;

/// Smoothings with which it begins at a cold start, tried in turn: a path may end at a fold, and
/// most folds lie on few paths. More would not help: searching the modes of what these leave costs
/// less than following ten more paths.
const COLD_SMOOTHINGS: [f64; 2] = [1.0, 1e-1];

/// Smoothing with which it begins where the pusher yields at its stall force.
const YIELDING_SMOOTHING: f64 = 1e-4;

/// Compliance κ of the gap rows where no exact solution exists (docs/method.md (14)).
const COMPLIANCE: f64 = 1e-6;

/// Compliance ten times above the first one on the way to the compliant solution.
const SOFT_COMPLIANCE: f64 = 10.0;

/// Smoothings tried at each compliance on that way.
const COMPLIANT_SMOOTHINGS: [f64; 4] = [1.0, 1e-2, 1e2, 1e-4];

/// Homotopy, exhaustive search and compliant solution, in this order, with their working memory.
#[derive(Clone, Debug, Default)]
pub struct Fallback {
    ncp: Ncp<1>,
    scalar: ScalarNcp,
    start: Unknowns<1>,
    nearest: Unknowns<1>,
    homotopy: Homotopy,
    refiner: Refiner,
}

impl Fallback {
    /// Solves one lane of `ncp` from its warm start; the result is on the lane's own contacts,
    /// without padding rows.
    #[inline(never)]
    pub fn solve<const W: usize>(
        &mut self,
        ncp: &Ncp<W>,
        warm: &Unknowns<W>,
        lane: usize,
        report: &mut Report,
    ) -> &Unknowns<1> {
        self.ncp.clear();
        ncp.pack_lane(lane, &mut self.ncp, 0);
        self.scalar.assign(&self.ncp);
        self.start.clear(self.ncp.contacts.len());
        warm.pack_lane(ncp, lane, &mut self.start, 0);
        self.solve_loaded(report);
        &self.refiner.z
    }

    fn solve_loaded(&mut self, report: &mut Report) {
        // the warm start's own modes
        report.route = Route::Homotopy;
        report.residual =
            self.refiner
                .try_modes(&self.ncp, &self.start, &WARM_SLIDING, WARM_ITERATIONS);
        // the homotopy from the warm start, then from cold ones
        if report.residual > TOLERANCE {
            report.residual = self.follow(WARM_SMOOTHING);
        }
        if report.residual > TOLERANCE {
            report.residual = self.follow_from_cold_starts();
        }
        // all modes; without a solution, the compliant problem
        if report.residual > TOLERANCE {
            report.route = Route::ModeSearch;
            report.outcome = self.search_modes();
            if report.outcome != Outcome::Solved {
                self.solve_compliant();
            }
            report.residual = self.ncp.residual(&self.refiner.z).0[0];
        }
    }

    /// The homotopy from cold starts, then from one where the pusher yields, until a refined end is
    /// certified; the residual of the last.
    fn follow_from_cold_starts(&mut self) -> f64 {
        for smoothing in COLD_SMOOTHINGS {
            self.start.cold_start(&self.ncp);
            let residual = self.follow(smoothing);
            if residual <= TOLERANCE {
                return residual;
            }
        }
        self.start.cold_start(&self.ncp);
        self.start.yield_pusher(&self.ncp);
        self.follow(YIELDING_SMOOTHING)
    }

    /// The homotopy from `self.start`, its end refined; the residual.
    fn follow(&mut self, smoothing: f64) -> f64 {
        let end = self.homotopy.follow(&self.ncp, &self.start, smoothing);
        self.refiner.refine(&self.ncp, end)
    }

    fn search_modes(&mut self) -> Outcome {
        let (ncp, refiner) = (&self.ncp, &mut self.refiner);
        let mut guess = Unknowns::zero(ncp.contacts.len());
        let mut accept = |candidate: &Candidate| {
            candidate.store(&mut guess);
            refiner.refine(ncp, &guess) <= TOLERANCE
        };
        match search(&self.scalar, &mut accept) {
            Verdict::Solved => Outcome::Solved,
            Verdict::Infeasible => Outcome::Infeasible,
            Verdict::Unresolved => Outcome::Failed,
        }
    }

    /// Leaves the solution with compliant gap rows in the refiner: from soft rows, where it is near
    /// the free motion, to stiff ones.
    fn solve_compliant(&mut self) {
        self.start.cold_start(&self.ncp);
        let mut compliance = SOFT_COMPLIANCE;
        while compliance > COMPLIANCE {
            compliance = f64::max(0.1 * compliance, COMPLIANCE);
            self.ncp.compliance = Lanes([compliance]);
            self.find_nearest();
            self.start.copy_from(&self.nearest);
        }
        self.refiner.z.copy_from(&self.nearest);
        self.ncp.compliance = Lanes::ZERO;
    }

    /// Leaves in `self.nearest` the point of least residual among the paths from `self.start` and
    /// their refined ends.
    ///
    /// Impulses may be of a million metres per second here, and then rounding alone exceeds the
    /// tolerance: the last attempt need not be the best.
    fn find_nearest(&mut self) {
        let mut least = f64::INFINITY;
        for smoothing in COMPLIANT_SMOOTHINGS {
            let refined = self.follow(smoothing);
            let end = self.homotopy.end();
            let unrefined = self.ncp.residual(end).0[0];
            for (residual, z) in [(refined, &self.refiner.z), (unrefined, end)] {
                if residual < least {
                    least = residual;
                    self.nearest.copy_from(z);
                }
            }
            if least <= TOLERANCE {
                break;
            }
        }
    }
}

impl Unknowns<1> {
    /// Makes the pusher of a cold start yield: its contacts carry the stall force and it gives up
    /// the whole approach.
    fn yield_pusher(&mut self, ncp: &Ncp<1>) {
        let stall = ncp.stall.0[0];
        for (row, p_n) in ncp.contacts.iter().zip(&mut self.normal) {
            let along = row.nd.0[0];
            if along > 0.0 && stall.is_finite() {
                *p_n = Lanes([stall / along]);
                self.pusher_yield = self.pusher_yield.max(-row.gap_offset);
            }
        }
    }
}
