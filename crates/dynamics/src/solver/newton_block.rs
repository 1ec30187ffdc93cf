//! The fast solver on a block of chunks: [`FastSolver`].
//!
//! A few iterations are enough for most lanes of a chunk. The others go on packed together, and one
//! that is done makes room for the next, so that no chunk iterates for one lane.

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;
use crate::solver::lane_queue::{Packed, Place};
use crate::solver::newton::{Goal, Newton, Progress, Together};
use crate::solver::source::Source;

/// How long the lanes of a chunk iterate together where there are other chunks to be packed with.
const TOGETHER: Together = Together {
    iterations: 4,
    lanes: 4,
};

/// How the iteration of one particle ended.
#[derive(Clone, Copy, Debug)]
pub struct Iterated {
    /// Which one it was.
    pub place: Place,
    /// Its residual (m/s).
    pub residual: f64,
    /// Its iterations.
    pub iterations: u32,
}

/// [`Newton`] on a block, with its working memory.
#[derive(Clone, Debug)]
pub struct FastSolver<const W: usize> {
    together: Newton<W>,
    alone: Newton<W>,
    packed: Packed<W>,
    progress: Progress<W>,
}

impl<const W: usize> Default for FastSolver<W> {
    fn default() -> Self {
        Self {
            together: Newton::default(),
            alone: Newton::default(),
            packed: Packed::default(),
            progress: Progress::NONE,
        }
    }
}

impl<const W: usize> FastSolver<W> {
    /// Iterates every lane of every chunk that comes from `source` until it has reached its goal or
    /// taken all iterations, and tells `finish` of it. What becomes of a lane does not depend on
    /// the others.
    #[inline(always)]
    pub fn solve(
        &mut self,
        source: &mut impl Source<W>,
        ncps: &mut [Ncp<W>],
        p: &mut [Impulses<W>],
        goal: Goal,
        finish: &mut impl FnMut(Iterated),
    ) {
        self.packed.clear();
        // a single chunk has nothing to be packed with
        let together = if ncps.len() > 1 {
            TOGETHER
        } else {
            Together::to_the_end(&goal)
        };
        for chunk in 0..ncps.len() {
            source.load(chunk, &mut ncps[chunk]);
            source.start(chunk, &ncps[chunk], &mut p[chunk]);
            let progress = self
                .together
                .begin(&ncps[chunk], &mut p[chunk], goal, together);
            for lane in (!progress.open).lanes() {
                finish(progress.ended(Place { chunk, lane }, lane));
            }
            for lane in progress.open.lanes() {
                while self.packed.busy.all() {
                    self.go_on(ncps, p, goal, finish);
                }
                self.pack(&ncps[chunk], &p[chunk], &progress, Place { chunk, lane });
            }
        }
        while self.packed.busy.any() {
            self.go_on(ncps, p, goal, finish);
        }
    }

    /// Copies a lane of the chunk that was begun last to the lanes that go on.
    #[inline(always)]
    fn pack(
        &mut self,
        ncp: &Ncp<W>,
        p: &Impulses<W>,
        progress: &Progress<W>,
        Place { chunk, lane }: Place,
    ) {
        if let Some(slot) = self.packed.load(ncp, p, lane, chunk * W + lane) {
            self.together
                .pack_lane(ncp, lane, &mut self.alone, &self.packed.ncp, slot);
            progress.pack_lane(lane, &mut self.progress, slot);
        }
    }

    /// One iteration of the packed lanes; those that are done go back where they came from.
    #[inline(always)]
    fn go_on(
        &mut self,
        ncps: &[Ncp<W>],
        p: &mut [Impulses<W>],
        goal: Goal,
        finish: &mut impl FnMut(Iterated),
    ) {
        let packed = &mut self.packed;
        self.alone
            .advance(&packed.ncp, &mut packed.p, goal, &mut self.progress);
        let done = packed.busy & !self.progress.open;
        for slot in done.lanes() {
            let place = Place {
                chunk: packed.tags[slot] / W,
                lane: packed.tags[slot] % W,
            };
            p[place.chunk].unpack_lane(&ncps[place.chunk], place.lane, &packed.p, slot);
            finish(self.progress.ended(place, slot));
        }
        packed.busy = packed.busy & !done;
    }
}

impl<const W: usize> Progress<W> {
    fn ended(&self, place: Place, lane: usize) -> Iterated {
        Iterated {
            place,
            residual: self.residual.0[lane],
            iterations: self.iterations.0[lane] as u32,
        }
    }
}
