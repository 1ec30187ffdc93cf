//! The second solver: one Newton step on the smoothed rows per reduction of ε, `W` particles side
//! by side.
//!
//! Where an object jams or rests among redundant contacts the natural map of the first solver jumps
//! between modes; smoothed rows do not. There is no line search: ε falls while the smoothed
//! residual is not too far above it, so that every particle does the same arithmetic. Long before ε
//! is small the modes show, and Newton's method with these modes held ends it. A lane that is done
//! takes up the next problem; lanes that look at their modes wait for others to look with them, so
//! that neither kind of step runs for few.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::natural_map::NaturalMap;
use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;
use crate::solver::fixed_modes::Polish;
use crate::solver::lane_queue::{Packed, Place};
use crate::solver::linearised::Linearised;
use crate::solver::smoothed::SmoothedMap;

/// Smallest ε, as a share of the speed scale.
const SMALLEST: f64 = 1e-11;

/// Newton steps on smoothed rows.
const STEPS: f64 = 30.0;

/// Factor by which ε falls between one look at the modes and the next.
const LOOK: f64 = 0.01;

/// Newton steps with modes held.
const POLISH_STEPS: u32 = 2;

/// A way down from a warm start.
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    /// First ε, as a share of the speed scale.
    pub start: f64,
    /// Factor by which ε falls.
    pub reduction: f64,
    /// Smoothed residual, in units of ε, below which it may fall.
    pub near: f64,
    /// Share of its bound above which an impulse is taken to slide.
    pub sliding: f64,
}

/// The problems of a block, `W` to a chunk, and the impulses they start from.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a, const W: usize> {
    /// The problems.
    pub ncps: &'a [Ncp<W>],
    /// The impulses.
    pub warm: &'a [Impulses<W>],
}

/// How one problem's descent ended.
#[derive(Clone, Copy, Debug)]
pub struct End<'a, const W: usize> {
    /// Which of the problems it was.
    pub task: usize,
    /// Residual of the last look at the modes (m/s); infinite without one.
    pub residual: f64,
    /// Newton steps on smoothed rows.
    pub steps: u32,
    /// The impulses, in lane `lane`.
    pub impulses: &'a Impulses<W>,
    /// See `impulses`.
    pub lane: usize,
}

/// The continuation with its working memory.
#[derive(Clone, Debug)]
pub struct Continuation<const W: usize> {
    /// Where each problem's path has come to.
    packed: Packed<W>,
    trial: Impulses<W>,
    map: SmoothedMap<W>,
    linearised: Linearised<W>,
    certificate: NaturalMap<W>,
    polish: Polish<W>,
    lanes: LaneStates<W>,
}

/// How far each lane is.
#[derive(Clone, Debug)]
struct LaneStates<const W: usize> {
    /// Those that are about to look at their modes.
    waiting: Mask<W>,
    epsilon: Lanes<W>,
    smallest: Lanes<W>,
    next_look: Lanes<W>,
    steps: Lanes<W>,
    residual: Lanes<W>,
}

impl<const W: usize> Default for Continuation<W> {
    fn default() -> Self {
        let (o, no) = (Lanes::ZERO, Mask::splat(false));
        Self {
            packed: Packed::default(),
            trial: Impulses::zero(0),
            map: SmoothedMap::default(),
            linearised: Linearised::default(),
            certificate: NaturalMap::default(),
            polish: Polish::default(),
            lanes: LaneStates {
                waiting: no,
                epsilon: o,
                smallest: o,
                next_look: o,
                steps: o,
                residual: o,
            },
        }
    }
}

impl<const W: usize> Continuation<W> {
    /// Goes down from the warm starts of the problems at `places`; tells `finish` how each ended,
    /// solved where its residual is at most `tolerance`. What becomes of a problem does not depend
    /// on the others.
    #[inline(always)]
    pub fn solve(
        &mut self,
        block: Block<'_, W>,
        places: &[Place],
        descent: &Descent,
        tolerance: f64,
        finish: &mut impl FnMut(&End<'_, W>),
    ) {
        let mut next = 0;
        self.packed.clear();
        loop {
            while next < places.len() && !self.packed.busy.all() {
                self.load(block, places[next], next, descent);
                next += 1;
            }
            if !self.packed.busy.any() {
                return;
            }
            let violation = self
                .map
                .take(&self.packed.ncp, &self.packed.p, self.lanes.epsilon);
            let near = violation.lt(self.lanes.epsilon * descent.near);
            self.lanes.note(self.packed.busy, near);
            if self.lanes.enough_wait(self.packed.busy) {
                self.look(descent, tolerance);
            }
            self.end_where_over(tolerance, finish);
            self.advance(near, descent);
        }
    }

    /// Puts a problem into a free lane.
    #[inline(always)]
    fn load(
        &mut self,
        Block { ncps, warm }: Block<'_, W>,
        Place { chunk, lane }: Place,
        task: usize,
        descent: &Descent,
    ) {
        let Some(slot) = self.packed.load(&ncps[chunk], &warm[chunk], lane, task) else {
            return;
        };
        let scale = ncps[chunk].speed_scale().0[lane];
        let lanes = &mut self.lanes;
        lanes.waiting.set(slot, false);
        for (number, value) in [
            (&mut lanes.epsilon, scale * descent.start),
            (&mut lanes.next_look, scale * descent.start),
            (&mut lanes.smallest, scale * SMALLEST),
            (&mut lanes.steps, 0.0),
            (&mut lanes.residual, f64::INFINITY),
        ] {
            number.0[slot] = value;
        }
    }

    /// Tries the modes that the path shows in the lanes that wait for it.
    #[inline(always)]
    fn look(&mut self, descent: &Descent, tolerance: f64) {
        let looking = self.lanes.waiting;
        self.trial.copy_from(&self.packed.p);
        self.polish.polish(
            &self.packed.ncp,
            &mut self.trial,
            looking,
            descent.sliding,
            POLISH_STEPS,
        );
        let residual = self.certificate.take(&self.packed.ncp, &self.trial);
        let lanes = &mut self.lanes;
        lanes.residual = looking.select(residual, lanes.residual);
        lanes.next_look = looking.select(lanes.next_look * LOOK, lanes.next_look);
        // what has no smaller ε to go to ends here
        let last =
            looking & residual.gt(Lanes::splat(tolerance)) & !lanes.epsilon.gt(lanes.smallest);
        lanes.steps = last.select(Lanes::splat(STEPS), lanes.steps);
        lanes.waiting = Mask::splat(false);
    }

    /// Frees the lanes that are solved or have taken all steps.
    #[inline(always)]
    fn end_where_over(&mut self, tolerance: f64, finish: &mut impl FnMut(&End<'_, W>)) {
        let (lanes, packed) = (&self.lanes, &mut self.packed);
        let solved = !lanes.residual.gt(Lanes::splat(tolerance));
        let over = packed.busy & !lanes.waiting & (solved | !lanes.steps.lt(Lanes::splat(STEPS)));
        if !over.any() {
            return;
        }
        for lane in over.lanes() {
            let (task, steps) = (packed.tags[lane], lanes.steps.0[lane] as u32);
            finish(&End {
                task,
                residual: lanes.residual.0[lane],
                steps,
                impulses: &self.trial,
                lane,
            });
        }
        packed.busy = packed.busy & !over;
    }

    /// One step in every lane that does not wait; ε falls in those of `near`.
    #[inline(always)]
    fn advance(&mut self, near: Mask<W>, descent: &Descent) {
        let (lanes, Packed { ncp, p, busy, .. }) = (&mut self.lanes, &mut self.packed);
        let going = *busy & !lanes.waiting;
        if !going.any() {
            return;
        }
        let target = near.select(lanes.epsilon * descent.reduction, lanes.epsilon);
        self.linearised.smoothed(ncp, p, &self.map, target);
        self.linearised.step(ncp, p, going);
        lanes.epsilon = going.select(target, lanes.epsilon);
        lanes.steps += going.zero_unless(Lanes::splat(1.0));
    }
}

impl<const W: usize> LaneStates<W> {
    /// Lanes `near` their ε wait for a look at their modes where it has fallen far enough.
    #[inline(always)]
    fn note(&mut self, busy: Mask<W>, near: Mask<W>) {
        let look = near & self.steps.gt(Lanes::ZERO) & !self.epsilon.gt(self.next_look);
        self.waiting = busy & (self.waiting | look);
    }

    /// Whether half of the lanes with a problem wait.
    #[inline(always)]
    fn enough_wait(&self, busy: Mask<W>) -> bool {
        let [waiting, busy] = [self.waiting.count(), busy.count()];
        waiting > 0 && 2 * waiting >= busy
    }
}
