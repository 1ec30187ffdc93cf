//! The semismooth Newton iteration on single lanes of many chunks, side by side: [`NewtonQueue`].

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;
use crate::solver::lane_queue::{LaneIndex, LaneQueue};
use crate::solver::newton::{Newton, NewtonSettings, Progress};

/// Residual (m/s) above which an iterate is far from any solution: impulses have come near the
/// penalty.
const FAR: f64 = 10.0;

/// Iterations after which lanes far from a solution are given up, no fewer than a chunk takes as a
/// whole. Where active rows contradict each other, as in an object wedged between pusher and
/// fixels, modes return in a cycle, and impulses with them.
const PATIENCE: f64 = 8.0;

/// Problems under way: [`Newton`] at the point of a [`LaneQueue`].
#[derive(Clone, Debug, Default)]
pub struct NewtonQueue<const W: usize> {
    newton: Newton<W>,
    queue: LaneQueue<W>,
    progress: Progress<W>,
}

/// State of an iteration that goes on in a queue.
#[derive(Clone, Copy, Debug)]
pub struct Underway<'a, const W: usize> {
    /// Its memory.
    pub newton: &'a Newton<W>,
    /// Its progress.
    pub progress: &'a Progress<W>,
    /// The problems.
    pub ncp: &'a Ncp<W>,
    /// The point that it has reached.
    pub z: &'a Unknowns<W>,
}

/// A problem whose iteration has ended in a queue.
#[derive(Clone, Copy, Debug)]
pub struct Ended<'a, const W: usize> {
    /// The problem.
    pub index: LaneIndex,
    /// Its lane of the queue.
    pub slot: usize,
    /// Progress of all lanes.
    pub progress: &'a Progress<W>,
    /// The points of all lanes.
    pub z: &'a Unknowns<W>,
}

impl<const W: usize> NewtonQueue<W> {
    /// Removes all problems.
    pub fn clear(&mut self) {
        self.queue.clear();
    }

    /// Lanes with a problem.
    #[inline(always)]
    pub fn busy(&self) -> Mask<W> {
        self.queue.busy
    }

    /// Takes the problem `index`, which is in one `lane` of `from`; a lane must be free.
    #[inline(always)]
    pub fn load<const V: usize>(&mut self, index: LaneIndex, from: &Underway<'_, V>, lane: usize) {
        let slot = self.queue.load(index, from.ncp, lane, from.z);
        let contacts = self.queue.ncp.contacts.len();
        from.newton
            .pack_lane(from.ncp, lane, &mut self.newton, contacts, slot);
        from.progress.pack_lane(lane, &mut self.progress, slot);
    }

    /// One iteration of all problems; `finish` hears of each that ends by it.
    #[inline(always)]
    pub fn iterate(&mut self, settings: NewtonSettings, mut finish: impl FnMut(Ended<'_, W>)) {
        let queue = &mut self.queue;
        self.newton
            .iterate(&queue.ncp, &mut queue.z, settings, &mut self.progress);
        self.progress.give_up_far();
        let finished = queue.busy & !self.progress.running;
        for slot in finished.lanes() {
            finish(Ended {
                index: queue.indices[slot],
                slot,
                progress: &self.progress,
                z: &queue.z,
            });
        }
        queue.busy = queue.busy & !finished;
    }

    /// Hands all problems to a queue that has room for them.
    #[inline(always)]
    pub fn move_to<const V: usize>(&mut self, other: &mut NewtonQueue<V>) {
        let from = Underway {
            newton: &self.newton,
            progress: &self.progress,
            ncp: &self.queue.ncp,
            z: &self.queue.z,
        };
        for slot in self.queue.busy.lanes() {
            other.load(self.queue.indices[slot], &from, slot);
        }
        self.queue.busy = Mask::splat(false);
    }
}

impl<const W: usize> Progress<W> {
    /// Ends lanes that are far off after [`PATIENCE`] iterations.
    #[inline(always)]
    fn give_up_far(&mut self) {
        let patient = self.iterations.lt(Lanes::splat(PATIENCE));
        self.running = self.running & (patient | !self.residual.gt(Lanes::splat(FAR)));
    }
}
