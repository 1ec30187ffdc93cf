//! The path of smoothed solutions, followed to ε = 0, `W` particles side by side: [`SmoothedPath`].
//!
//! Where an object jams or rests among redundant contacts, the natural map jumps between modes;
//! smoothed rows do not. There is no line search: ε falls while the smoothed residual stays within
//! a multiple of it, so that every particle does the same arithmetic. Long before ε is small the
//! modes show, and Newton's method in fixed modes ends it. A lane that finishes takes the next
//! problem. Lanes in which fixed modes are due wait until half of all lanes are, so that neither
//! kind of step runs for few.

use std::slice::from_ref;

use stickslip_lanes::{Lanes, Level, Mask, on_fused};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::report::TOLERANCE;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::fixed_mode_newton::FixedModeNewton;
use crate::solver::lane_queue::{LaneIndex, LaneQueue};
use crate::solver::linearised::Linearised;
use crate::solver::smoothed_map::SmoothedMap;

/// Smallest ε, as a share of the speed scale.
const SMALLEST: f64 = 1e-11;

/// Factor by which ε falls between one attempt with fixed modes and the next.
const ATTEMPT_REDUCTION: f64 = 0.01;

/// Newton steps in fixed modes.
const FIXED_MODE_STEPS: u32 = 2;

/// Share of its bound above which an impulse is taken to slide.
const SLIDING: f64 = 0.9999;

/// Next to a warm start: nearly every Newton step reduces ε a hundredfold.
pub const BOLD: SmoothingSchedule = SmoothingSchedule {
    start: 1e-7,
    reduction: 0.01,
    near: 1e6,
    steps: 30.0,
};

/// From far away.
pub const CAREFUL: SmoothingSchedule = SmoothingSchedule {
    start: 1.0,
    reduction: 0.3,
    near: 1.0,
    steps: 60.0,
};

/// Schedule by which ε falls.
#[derive(Clone, Copy, Debug)]
pub struct SmoothingSchedule {
    /// First ε, as a share of the speed scale.
    pub start: f64,
    /// Factor by which ε falls.
    pub reduction: f64,
    /// Smoothed residual, in units of ε, below which ε may fall.
    pub near: f64,
    /// Most Newton steps on smoothed rows.
    pub steps: f64,
}

/// The problems of a block, `W` to a chunk, and the points they start from.
#[derive(Clone, Copy, Debug)]
pub struct StartedBlock<'a, const W: usize> {
    /// The problems.
    pub ncps: &'a [Ncp<W>],
    /// The points.
    pub start: &'a [Unknowns<W>],
}

/// Outcome of one problem.
#[derive(Clone, Copy, Debug)]
pub struct Finished<'a, const W: usize> {
    /// The particle.
    pub index: LaneIndex,
    /// Residual of the last attempt with fixed modes (m/s); infinite without one.
    pub residual: f64,
    /// Newton steps on smoothed rows.
    pub steps: u32,
    /// The result of that attempt, or the last point of the path, in lane `slot`.
    pub z: &'a Unknowns<W>,
    /// See `z`.
    pub slot: usize,
}

/// The smoothed Newton steps with their working memory.
#[derive(Clone, Debug, Default)]
pub struct SmoothedPath<const W: usize> {
    queue: LaneQueue<W>,
    progress: Progress<W>,
    map: SmoothedMap<W>,
    linearised: Linearised<W>,
    /// Result of the last attempt with fixed modes.
    trial: Unknowns<W>,
    fixed_modes: FixedModeNewton<W>,
    certificate: NaturalMap<W>,
}

/// Progress of each lane.
#[derive(Clone, Debug)]
struct Progress<const W: usize> {
    epsilon: Lanes<W>,
    smallest: Lanes<W>,
    /// ε at which fixed modes are tried next.
    next_attempt: Lanes<W>,
    /// Lanes that wait for it.
    due: Mask<W>,
    steps: Lanes<W>,
    /// Of the last attempt.
    residual: Lanes<W>,
}

impl<const W: usize> Default for Progress<W> {
    fn default() -> Self {
        Self {
            epsilon: Lanes::ZERO,
            smallest: Lanes::ZERO,
            next_attempt: Lanes::ZERO,
            due: Mask::splat(false),
            steps: Lanes::ZERO,
            residual: Lanes::ZERO,
        }
    }
}

impl<const W: usize> SmoothedPath<W> {
    /// Follows `schedule` from the starts of the given particles; reports to `finish` how each
    /// ended. A particle is solved if its residual is at most `tolerance`. A particle's result does
    /// not depend on the others.
    #[inline(always)]
    pub fn solve(
        &mut self,
        block: StartedBlock<'_, W>,
        particles: &[LaneIndex],
        schedule: &SmoothingSchedule,
        tolerance: f64,
        finish: &mut impl FnMut(&Finished<'_, W>),
    ) {
        let mut next = 0;
        self.queue.clear();
        loop {
            // free lanes take the next problems
            while next < particles.len() && !self.queue.busy.all() {
                self.load(block, particles[next], schedule);
                next += 1;
            }
            if !self.queue.busy.any() {
                return;
            }
            // where the point is near the path, ε may fall
            let epsilon = self.progress.epsilon;
            let violation = self.map.evaluate(&self.queue.ncp, &self.queue.z, epsilon);
            let near = violation.lt(epsilon * schedule.near);
            // fixed modes, once enough lanes are due
            self.progress.update_due(self.queue.busy, near);
            if self.progress.enough_due(self.queue.busy) {
                self.try_fixed_modes(tolerance, schedule.steps);
            }
            self.remove_finished(tolerance, schedule.steps, finish);
            self.step(near, schedule);
        }
    }

    /// Puts a problem into a free lane; there must be one.
    #[inline(always)]
    fn load(
        &mut self,
        StartedBlock { ncps, start }: StartedBlock<'_, W>,
        index: LaneIndex,
        schedule: &SmoothingSchedule,
    ) {
        let ncp = &ncps[index.chunk];
        let slot = self.queue.load(index, ncp, index.lane, &start[index.chunk]);
        let scale = ncp.speed_scale().0[index.lane];
        let progress = &mut self.progress;
        progress.epsilon.0[slot] = scale * schedule.start;
        progress.smallest.0[slot] = scale * SMALLEST;
        progress.next_attempt.0[slot] = scale * schedule.start;
        progress.due.set(slot, false);
        progress.steps.0[slot] = 0.0;
        progress.residual.0[slot] = f64::INFINITY;
    }

    /// Newton in the modes that the smoothed points show, in the lanes where it is due.
    #[inline(always)]
    fn try_fixed_modes(&mut self, tolerance: f64, most_steps: f64) {
        let due = self.progress.due;
        self.trial.copy_from(&self.queue.z);
        self.fixed_modes.solve(
            &self.queue.ncp,
            &mut self.trial,
            due,
            SLIDING,
            FIXED_MODE_STEPS,
        );
        let residual = self.certificate.evaluate(&self.queue.ncp, &self.trial);
        let progress = &mut self.progress;
        progress.residual = due.select(residual, progress.residual);
        progress.next_attempt = due.select(
            progress.next_attempt * ATTEMPT_REDUCTION,
            progress.next_attempt,
        );
        // a lane without a smaller ε to go to has taken its last step
        let last =
            due & residual.gt(Lanes::splat(tolerance)) & !progress.epsilon.gt(progress.smallest);
        progress.steps = last.select(Lanes::splat(most_steps), progress.steps);
        progress.due = Mask::splat(false);
    }

    /// Frees the lanes that are solved or have taken all steps.
    #[inline(always)]
    fn remove_finished(
        &mut self,
        tolerance: f64,
        most_steps: f64,
        finish: &mut impl FnMut(&Finished<'_, W>),
    ) {
        let (progress, queue) = (&self.progress, &mut self.queue);
        let solved = !progress.residual.gt(Lanes::splat(tolerance));
        let exhausted = !progress.steps.lt(Lanes::splat(most_steps));
        let finished = queue.busy & !progress.due & (solved | exhausted);
        if !finished.any() {
            return;
        }
        self.trial.resize(queue.ncp.contacts.len());
        for slot in finished.lanes() {
            if progress.residual.0[slot] == f64::INFINITY {
                queue.z.pack_lane(&queue.ncp, slot, &mut self.trial, slot);
            }
            finish(&Finished {
                index: queue.indices[slot],
                residual: progress.residual.0[slot],
                steps: progress.steps.0[slot] as u32,
                z: &self.trial,
                slot,
            });
        }
        queue.busy = queue.busy & !finished;
    }

    /// One step in every lane where fixed modes are not due; ε falls in those of `near`.
    #[inline(always)]
    fn step(&mut self, near: Mask<W>, schedule: &SmoothingSchedule) {
        let (progress, LaneQueue { ncp, z, busy, .. }) = (&mut self.progress, &mut self.queue);
        let stepping = *busy & !progress.due;
        if !stepping.any() {
            return;
        }
        let target = near.select(progress.epsilon * schedule.reduction, progress.epsilon);
        self.linearised
            .linearise_smoothed_map(ncp, z, &self.map, target);
        self.linearised.step(ncp, z, stepping);
        progress.epsilon = stepping.select(target, progress.epsilon);
        progress.steps += stepping.zero_unless(Lanes::splat(1.0));
    }
}

impl<const W: usize> Progress<W> {
    /// Fixed modes become due in lanes near the path whose ε has fallen far enough.
    #[inline(always)]
    fn update_due(&mut self, busy: Mask<W>, near: Mask<W>) {
        let fallen = near & self.steps.gt(Lanes::ZERO) & !self.epsilon.gt(self.next_attempt);
        self.due = busy & (self.due | fallen);
    }

    /// Returns true if they are due in half of the lanes with a problem.
    #[inline(always)]
    fn enough_due(&self, busy: Mask<W>) -> bool {
        let [due, busy] = [self.due.count(), busy.count()];
        due > 0 && 2 * due >= busy
    }
}

impl SmoothedPath<1> {
    /// Follows `schedule` in a single problem and leaves its end in `z`; its residual, infinite
    /// where fixed modes were never tried, and the Newton steps.
    pub fn solve_one(
        &mut self,
        level: Level,
        ncp: &Ncp<1>,
        start: &Unknowns<1>,
        schedule: &SmoothingSchedule,
        z: &mut Unknowns<1>,
    ) -> (f64, u32) {
        let block = StartedBlock {
            ncps: from_ref(ncp),
            start: from_ref(start),
        };
        let mut end = (f64::INFINITY, 0);
        z.resize(ncp.contacts.len());
        on_fused(
            level,
            #[inline(always)]
            || {
                let only = [LaneIndex { chunk: 0, lane: 0 }];
                self.solve(block, &only, schedule, TOLERANCE, &mut |finished| {
                    z.unpack_lane(ncp, 0, finished.z, finished.slot);
                    end = (finished.residual, finished.steps);
                });
            },
        );
        end
    }
}
