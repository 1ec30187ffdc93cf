//! Particles that the solvers in lanes leave unsolved, one at a time: [`Fallback`].

use stickslip_lanes::{Lanes, Level};

use crate::ncp::report::{Outcome, Report, Route, TOLERANCE};
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::chain::NEWTON;
use crate::solver::compliant::CompliantNewton;
use crate::solver::exhaustive::certifier::{Certifier, Effort, Judged};
use crate::solver::exhaustive::mode_search::{Verdict, search};
use crate::solver::exhaustive::relief::relieve;
use crate::solver::exhaustive::scalar_ncp::{Candidate, ScalarNcp};
use crate::solver::refiner::Refiner;
use crate::solver::smoothed_path::{CAREFUL, SmoothedPath};

/// Most work spent on one problem, in linear systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkLimit {
    /// By the search over modes.
    pub search: u32,
    /// By the compliant solver.
    pub compliant: u32,
}

/// The search over contact modes and, without a solution, the compliant one, with their working
/// memory.
#[derive(Clone, Debug)]
pub struct Fallback {
    ncp: Ncp<1>,
    scalar: ScalarNcp,
    guess: Unknowns<1>,
    solution: Unknowns<1>,
    refiner: Refiner,
    path: SmoothedPath<1>,
    compliant: CompliantNewton,
    level: Level,
}

impl Default for Fallback {
    fn default() -> Self {
        Self {
            ncp: Ncp::default(),
            scalar: ScalarNcp::default(),
            guess: Unknowns::default(),
            solution: Unknowns::default(),
            refiner: Refiner::default(),
            path: SmoothedPath::default(),
            compliant: CompliantNewton::default(),
            level: Level::new(),
        }
    }
}

impl Fallback {
    /// Solves one lane of `ncp` with at most so much work; the
    /// result is on the lane's own contacts, without padding rows.
    #[inline(never)]
    pub fn solve<const W: usize>(
        &mut self,
        ncp: &Ncp<W>,
        lane: usize,
        limit: WorkLimit,
        report: &mut Report,
    ) -> &Unknowns<1> {
        self.ncp.clear();
        ncp.pack_lane(lane, &mut self.ncp, 0);
        self.scalar.assign(&self.ncp);
        report.route = Route::ModeSearch;
        self.search_modes(limit.search, report);
        if report.outcome == Outcome::Failed {
            self.start_afresh(report);
        }
        let solution = match report.outcome {
            Outcome::Solved => &self.solution,
            Outcome::Infeasible | Outcome::Failed => {
                report.systems += self.compliant.solve(&self.ncp, limit.compliant);
                &self.compliant.z
            }
        };
        report.residual = self.ncp.residual(solution).0[0];
        solution
    }

    /// Makes impulses smaller that cancel each other, in the lanes that are solved with large ones.
    #[inline(never)]
    pub fn relieve_lanes<const W: usize>(
        &mut self,
        ncp: &Ncp<W>,
        z: &mut Unknowns<W>,
        reports: &mut [Report; W],
    ) {
        let bounded = z.is_bounded();
        for (lane, report) in reports.iter_mut().enumerate() {
            if bounded.lane(lane) || report.outcome != Outcome::Solved {
                continue;
            }
            if let Some((relieved, residual)) = self.relieve(ncp, lane, z) {
                z.unpack_lane(ncp, lane, relieved, 0);
                report.residual = residual;
            }
        }
    }

    /// A solution of one lane of `ncp` with smaller impulses than `z` has, and its residual; `None`
    /// where none was found.
    fn relieve<const W: usize>(
        &mut self,
        ncp: &Ncp<W>,
        lane: usize,
        z: &Unknowns<W>,
    ) -> Option<(&Unknowns<1>, f64)> {
        self.ncp.clear();
        ncp.pack_lane(lane, &mut self.ncp, 0);
        self.scalar.assign(&self.ncp);
        let [vx, vy, turn] = z.v.map(|x| x.0[lane]);
        let v = [vx, vy, turn, z.pusher_yield.0[lane]];
        self.solution.clear(self.ncp.contacts.len());
        relieve(&self.scalar, &v)?.store(&mut self.solution);
        let residual = self.ncp.residual(&self.solution).0[0];
        let smaller = self.solution.largest_normal().0[0] < z.largest_normal().0[lane];
        (smaller && residual <= TOLERANCE).then_some((&self.solution, residual))
    }

    /// Leaves the search's result in `self.solution`.
    fn search_modes(&mut self, limit: u32, report: &mut Report) {
        let (ncp, refiner, guess) = (&self.ncp, &mut self.refiner, &mut self.guess);
        guess.clear(ncp.contacts.len());
        let mut judge = |candidate: &Candidate, effort| {
            candidate.store(guess);
            match effort {
                Effort::AsItIs => refiner.accept(ncp, guess),
                Effort::Refine => refiner.refine(ncp, guess),
            }
        };
        let mut certifier = Certifier::new(&mut judge, limit);
        report.outcome = match search(&self.scalar, &mut certifier) {
            Verdict::Solved => Outcome::Solved,
            Verdict::Infeasible => Outcome::Infeasible,
            Verdict::Unresolved => Outcome::Failed,
        };
        report.systems += limit - certifier.left();
        self.solution.copy_from(&self.refiner.z);
    }

    /// Solves a problem that the search leaves open, from the free motion: the last step's impulses
    /// may have led the first solvers astray. Tries the Newton iteration, then the path.
    fn start_afresh(&mut self, report: &mut Report) {
        self.guess.cold_start(&self.ncp);
        let (ncp, start, end) = (&self.ncp, &self.guess, &mut self.solution);
        let Judged { certified, systems } = self.refiner.iterate(ncp, start, NEWTON);
        report.systems += systems;
        if certified {
            report.outcome = Outcome::Solved;
            end.copy_from(&self.refiner.z);
            return;
        }
        let (residual, steps) = self.path.solve_one(self.level, ncp, start, &CAREFUL, end);
        report.systems += steps;
        if ncp.certifies(end, Lanes([residual])).all() {
            report.outcome = Outcome::Solved;
        }
    }
}
