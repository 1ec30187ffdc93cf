//! The semismooth Newton iteration on a block of chunks: [`NewtonBlock`].
//!
//! Most lanes of a chunk need few iterations. The others are packed into a queue of lanes and go on
//! there; a lane that finishes takes the next problem, so that no chunk iterates for one lane.

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::lane_queue::{LaneIndex, LaneQueue};
use crate::solver::newton::{BatchLimits, Newton, NewtonSettings, Progress};
use crate::solver::source::Source;

/// How long a chunk iterates as a whole where its last lanes can be queued with those of others.
const BATCH: BatchLimits = BatchLimits {
    iterations: 4,
    lanes: 4,
};

/// How the iteration of one particle ended.
#[derive(Clone, Copy, Debug)]
pub struct Iterated {
    /// Which particle.
    pub index: LaneIndex,
    /// Its residual (m/s).
    pub residual: f64,
    /// Its iterations.
    pub iterations: u32,
}

/// [`Newton`] on a block, with its working memory.
#[derive(Clone, Debug, Default)]
pub struct NewtonBlock<const W: usize> {
    chunk: Newton<W>,
    queued: Newton<W>,
    queue: LaneQueue<W>,
    progress: Progress<W>,
}

impl<const W: usize> NewtonBlock<W> {
    /// Iterates every lane of every chunk that comes from `source` until it converges or has taken
    /// all iterations, and reports each to `finish`. A lane's result does not depend on the others.
    #[inline(always)]
    pub fn solve(
        &mut self,
        source: &mut impl Source<W>,
        ncps: &mut [Ncp<W>],
        z: &mut [Unknowns<W>],
        settings: NewtonSettings,
        finish: &mut impl FnMut(Iterated),
    ) {
        self.queue.clear();
        // a single chunk's lanes have nobody to share a queue with
        let limits = if ncps.len() > 1 {
            BATCH
        } else {
            BatchLimits::until_finished(&settings)
        };
        // after the last chunk the queue empties, in the same call of an iteration: what is inlined there is much code
        let chunks = ncps.len();
        for chunk in 0..=chunks {
            let mut progress = Progress::default();
            if chunk < chunks {
                // the chunk as a whole
                source.load(chunk, &mut ncps[chunk]);
                source.start(chunk, &ncps[chunk], &mut z[chunk]);
                progress = self
                    .chunk
                    .begin(&ncps[chunk], &mut z[chunk], settings, limits);
                for lane in (!progress.running).lanes() {
                    finish(progress.iterated(LaneIndex { chunk, lane }, lane));
                }
            }
            // unfinished lanes are queued as soon as there is room
            let mut waiting = progress.running.lanes().peekable();
            while waiting.peek().is_some() || chunk == chunks && self.queue.busy.any() {
                match waiting.next_if(|_| !self.queue.busy.all()) {
                    Some(lane) => self.enqueue(
                        LaneIndex { chunk, lane },
                        &ncps[chunk],
                        &z[chunk],
                        &progress,
                    ),
                    None => self.iterate_queue(ncps, z, settings, finish),
                }
            }
        }
    }

    /// Copies a lane of the chunk that was begun last into the queue.
    #[inline(always)]
    fn enqueue(&mut self, index: LaneIndex, ncp: &Ncp<W>, z: &Unknowns<W>, progress: &Progress<W>) {
        if let Some(slot) = self.queue.load(index, ncp, z) {
            self.chunk
                .pack_lane(ncp, index.lane, &mut self.queued, &self.queue.ncp, slot);
            progress.pack_lane(index.lane, &mut self.progress, slot);
        }
    }

    /// One iteration of the queued lanes; results of those that finish go back to their chunks.
    #[inline(always)]
    fn iterate_queue(
        &mut self,
        ncps: &[Ncp<W>],
        z: &mut [Unknowns<W>],
        settings: NewtonSettings,
        finish: &mut impl FnMut(Iterated),
    ) {
        let queue = &mut self.queue;
        self.queued
            .iterate(&queue.ncp, &mut queue.z, settings, &mut self.progress);
        let finished = queue.busy & !self.progress.running;
        for slot in finished.lanes() {
            let index = queue.indices[slot];
            let LaneIndex { chunk, lane } = index;
            z[chunk].unpack_lane(&ncps[chunk], lane, &queue.z, slot);
            finish(self.progress.iterated(index, slot));
        }
        queue.busy = queue.busy & !finished;
    }
}

impl<const W: usize> Progress<W> {
    /// The progress in one lane, which belongs to particle `index`.
    #[inline(always)]
    fn iterated(&self, index: LaneIndex, lane: usize) -> Iterated {
        Iterated {
            index,
            residual: self.residual.0[lane],
            iterations: self.iterations.0[lane] as u32,
        }
    }
}
