//! The semismooth Newton iteration on a block of chunks: [`NewtonBlock`].
//!
//! Most lanes of a chunk need few iterations. The others are packed into a queue of lanes and go on
//! there; a lane that finishes takes the next problem, so that no chunk iterates for one lane. The
//! last few of a block go on in a narrower queue.

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::lane_queue::LaneIndex;
use crate::solver::newton::{BatchLimits, Newton, NewtonSettings, Progress};
use crate::solver::newton_queue::{Ended, NewtonQueue, Underway};
use crate::solver::source::Source;

/// Limits up to which a chunk iterates as a whole, before its last lanes are queued with those of
/// others.
const BATCH: BatchLimits = BatchLimits {
    iterations: 4,
    lanes: 4,
};

/// Outcome of the iteration of one particle.
#[derive(Clone, Copy, Debug)]
pub struct Iterated {
    /// The particle.
    pub index: LaneIndex,
    /// Its residual (m/s).
    pub residual: f64,
    /// Its iterations.
    pub iterations: u32,
}

/// Lanes that the last problems of a block go on in: where a vector holds four numbers, half the
/// work.
const LAST: usize = 4;

/// [`Newton`] on a block, with its working memory.
#[derive(Clone, Debug, Default)]
pub struct NewtonBlock<const W: usize> {
    chunk: Newton<W>,
    queue: NewtonQueue<W>,
    last: NewtonQueue<LAST>,
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
        // after the last chunk the queue empties, in the same call of an iteration: what is inlined there is much code
        let chunks = ncps.len();
        let few = if W > LAST { LAST } else { 0 };
        for chunk in 0..=chunks {
            let mut progress = Progress::default();
            if chunk < chunks {
                // the chunk as a whole
                source.load(chunk, &mut ncps[chunk]);
                source.start(chunk, &ncps[chunk], &mut z[chunk]);
                progress = self
                    .chunk
                    .begin(&ncps[chunk], &mut z[chunk], settings, BATCH);
                for lane in (!progress.running).lanes() {
                    finish(progress.iterated(LaneIndex { chunk, lane }, lane));
                }
            }
            // unfinished lanes are queued as soon as there is room
            let mut waiting = progress.running.lanes().peekable();
            while waiting.peek().is_some()
                || chunk == chunks && self.queue.busy().count() as usize > few
            {
                match waiting.next_if(|_| !self.queue.busy().all()) {
                    Some(lane) => {
                        let from = Underway {
                            newton: &self.chunk,
                            progress: &progress,
                            ncp: &ncps[chunk],
                            z: &z[chunk],
                        };
                        self.queue.load(LaneIndex { chunk, lane }, &from, lane);
                    }
                    None => self.queue.iterate(
                        settings,
                        #[inline(always)]
                        |ended| give_back(&ended, ncps, z, finish),
                    ),
                }
            }
        }
        // the last few
        if few > 0 && self.queue.busy().any() {
            self.last.clear();
            self.queue.move_to(&mut self.last);
            while self.last.busy().any() {
                self.last.iterate(
                    settings,
                    #[inline(always)]
                    |ended| give_back(&ended, ncps, z, finish),
                );
            }
        }
    }
}

/// Copies the point of a problem that a queue has finished back to its chunk, and reports it.
#[inline(always)]
fn give_back<const W: usize, const V: usize>(
    ended: &Ended<'_, V>,
    ncps: &[Ncp<W>],
    z: &mut [Unknowns<W>],
    finish: &mut impl FnMut(Iterated),
) {
    let LaneIndex { chunk, lane } = ended.index;
    z[chunk].unpack_lane(&ncps[chunk], lane, ended.z, ended.slot);
    finish(ended.progress.iterated(ended.index, ended.slot));
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
