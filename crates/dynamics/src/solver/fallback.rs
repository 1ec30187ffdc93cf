//! The slow, sure part of the chain, one particle at a time: [`SlowSolver`].

use stickslip_lanes::{Lanes, Level, Mask, on_widest};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::report::{Outcome, Report, Route, TOLERANCE};
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;
use crate::solver::fixed_modes::Polish;
use crate::solver::mode_rows::{Guess, Rows};
use crate::solver::mode_search::{Verdict, search};
use crate::solver::newton::{Goal, Newton};
use crate::solver::path::Homotopy;

/// Iterations that polish an end point.
const POLISH_ITERATIONS: u32 = 30;

/// The same by the fast solver.
const POLISHED: Goal = Goal {
    residual: TOLERANCE,
    iterations: POLISH_ITERATIONS,
    weight: 1.0,
};

/// Smoothings at which the homotopy takes up cold starts, one after the other: a path may end at a
/// fold, and most folds lie on few paths. What none of these solves costs the search over modes
/// less than ten more of them.
const HOLDING: [f64; 2] = [1.0, 1e-1];

/// The same with the pusher yielding at its stall force.
const YIELDING: [f64; 1] = [1e-4];

/// Compliance ten times above the one at which the way to the compliant solution begins.
const SOFT: f64 = 10.0;

/// Smoothings tried at each compliance on that way.
const SOFTENING: [f64; 4] = [1.0, 1e-2, 1e2, 1e-4];

/// Readings of a warm start: its own modes, then everything stuck, as where a jammed or resting
/// object stays.
const WARM_SLIDING: [f64; 2] = [0.9999, f64::INFINITY];

/// Newton steps in the modes of a warm start.
const WARM_POLISH: u32 = 5;

/// Smoothing at which the homotopy takes up a warm start, as a share of the problem's speed scale.
const WARM: f64 = 1e-3;

/// Shares of its bound above which an impulse is taken to slide, tried in turn.
const SLIDING: [f64; 3] = [0.9999, 0.98, 0.8];

/// Compliance κ of the gap rows where no exact solution exists (model.md, "Jamming").
const COMPLIANCE: f64 = 1e-6;

/// Homotopy, exhaustive search, compliant solution, in this order, with their working memory.
#[derive(Clone, Debug)]
pub struct SlowSolver {
    ncp: Ncp<1>,
    rows: Rows,
    start: Impulses<1>,
    nearest: Impulses<1>,
    homotopy: Homotopy,
    polisher: Polisher,
}

impl Default for SlowSolver {
    fn default() -> Self {
        Self {
            ncp: Ncp::empty(),
            rows: Rows::default(),
            start: Impulses::zero(0),
            nearest: Impulses::zero(0),
            homotopy: Homotopy::default(),
            polisher: Polisher::default(),
        }
    }
}

impl SlowSolver {
    /// Solves one lane of `ncp` from its warm start; the impulses are those of the lane's own
    /// contacts, without rows that pad it.
    #[inline(never)]
    pub fn solve<const W: usize>(
        &mut self,
        ncp: &Ncp<W>,
        warm: &Impulses<W>,
        lane: usize,
        report: &mut Report,
    ) -> &Impulses<1> {
        self.ncp.clear();
        ncp.pack_lane(lane, &mut self.ncp, 0);
        self.rows.assign(&self.ncp);
        self.start.clear(self.ncp.contacts.len());
        warm.pack_lane(ncp, lane, &mut self.start, 0);
        self.solve_loaded(report);
        &self.polisher.p
    }

    fn solve_loaded(&mut self, report: &mut Report) {
        report.route = Route::Homotopy;
        report.residual =
            self.polisher
                .try_modes(&self.ncp, &self.start, &WARM_SLIDING, WARM_POLISH);
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

    /// The homotopy from cold starts, with the pusher holding and with it yielding, until one of
    /// the polished ends is certified; the residual of the last.
    fn follow(&mut self) -> f64 {
        let mut residual = f64::INFINITY;
        let starts = HOLDING
            .iter()
            .map(|first| (false, first))
            .chain(YIELDING.iter().map(|first| (true, first)));
        for (yields, &first) in starts {
            self.start.cold_start(&self.ncp);
            if yields {
                self.start.yield_start(&self.ncp);
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
        let end = self.homotopy.follow(&self.ncp, &self.start, first);
        self.polisher.polish(&self.ncp, end)
    }

    fn search(&mut self) -> Outcome {
        let (ncp, polisher) = (&self.ncp, &mut self.polisher);
        let mut candidate = Impulses::zero(ncp.contacts.len());
        let mut accept = |guess: &Guess| {
            guess.store(&mut candidate);
            polisher.polish(ncp, &candidate) <= TOLERANCE
        };
        match search(&self.rows, &mut accept) {
            Verdict::Solved => Outcome::Solved,
            Verdict::Infeasible => Outcome::Infeasible,
            Verdict::Unresolved => Outcome::Failed,
        }
    }

    /// Leaves the solution with compliant gap rows in the polisher: from soft rows, where it is
    /// near the free motion, to stiff ones.
    fn solve_compliant(&mut self) {
        self.start.cold_start(&self.ncp);
        let mut compliance = SOFT;
        while compliance > COMPLIANCE {
            compliance = f64::max(0.1 * compliance, COMPLIANCE);
            self.ncp.compliance = Lanes([compliance]);
            self.come_nearest();
            self.start.copy_from(&self.nearest);
        }
        self.polisher.p.copy_from(&self.nearest);
        self.ncp.compliance = Lanes::ZERO;
    }

    /// Leaves in `self.nearest` what comes nearest to a solution from `self.start`.
    ///
    /// With impulses of a million metres per second, rounding alone may exceed the tolerance: then
    /// the last try need not be the best.
    fn come_nearest(&mut self) {
        let mut least = f64::INFINITY;
        for first in SOFTENING {
            let polished = self.follow_from(first);
            let smoothed = self.polisher.map.take(&self.ncp, self.homotopy.end()).0[0];
            for (residual, p) in [
                (polished, &self.polisher.p),
                (smoothed, self.homotopy.end()),
            ] {
                if residual < least {
                    least = residual;
                    self.nearest.copy_from(p);
                }
            }
            if least <= TOLERANCE {
                break;
            }
        }
    }
}

/// Turns a guess into certified impulses, where it is near enough.
#[derive(Clone, Debug)]
struct Polisher {
    p: Impulses<1>,
    modes: Polish<1>,
    newton: Newton<1>,
    map: NaturalMap<1>,
    level: Level,
}

impl Default for Polisher {
    fn default() -> Self {
        let (modes, newton, map) = (Polish::default(), Newton::default(), NaturalMap::default());
        Self {
            p: Impulses::zero(0),
            modes,
            newton,
            map,
            level: Level::new(),
        }
    }
}

impl Polisher {
    /// Newton in the modes that the guess itself shows; returns the residual.
    fn try_modes(&mut self, ncp: &Ncp<1>, guess: &Impulses<1>, sliding: &[f64], limit: u32) -> f64 {
        let mut residual = f64::INFINITY;
        for &share in sliding {
            self.p.copy_from(guess);
            residual = on_widest(
                self.level,
                #[inline(always)]
                || {
                    self.modes
                        .polish(ncp, &mut self.p, Mask::splat(true), share, limit);
                    self.map.take(ncp, &self.p).0[0]
                },
            );
            if residual <= TOLERANCE {
                break;
            }
        }
        residual
    }

    /// Polishes a guess, in its own modes, as it is, and by the fast solver; returns the residual,
    /// the impulses are in `self.p`.
    fn polish(&mut self, ncp: &Ncp<1>, guess: &Impulses<1>) -> f64 {
        let residual = self.try_modes(ncp, guess, &SLIDING, POLISH_ITERATIONS);
        if residual <= TOLERANCE {
            return residual;
        }
        self.p.copy_from(guess);
        on_widest(
            self.level,
            #[inline(always)]
            || self.newton.solve(ncp, &mut self.p, POLISHED).0[0],
        )
    }
}

impl Impulses<1> {
    /// Makes the pusher of a cold start yield: its contacts carry the stall force and it gives up
    /// the whole approach.
    fn yield_start(&mut self, ncp: &Ncp<1>) {
        let stall = ncp.stall.0[0];
        for (row, p_n) in ncp.contacts.iter().zip(&mut self.normal) {
            let along = row.nd.0[0];
            if along > 0.0 && stall.is_finite() {
                *p_n = Lanes([stall / along]);
                self.pusher_yield = self.pusher_yield.max(-row.gap);
            }
        }
    }
}
