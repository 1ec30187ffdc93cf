//! Problems from different chunks, side by side: [`LaneQueue`].

use stickslip_lanes::Mask;

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Unknowns;

/// Names one particle of a block.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneIndex {
    /// Number of its chunk.
    pub chunk: usize,
    /// Lane of the chunk.
    pub lane: usize,
}

/// Up to `W` problems, each in a lane of its own without padding rows, with the point that its
/// solver has reached. A lane that has finished is free for the next problem.
#[derive(Clone, Debug)]
pub struct LaneQueue<const W: usize> {
    /// The problems.
    pub ncp: Ncp<W>,
    /// The points.
    pub z: Unknowns<W>,
    /// Lanes with a problem.
    pub busy: Mask<W>,
    /// The particle that the problem in each lane belongs to.
    pub indices: [LaneIndex; W],
}

impl<const W: usize> Default for LaneQueue<W> {
    fn default() -> Self {
        Self {
            ncp: Ncp::default(),
            z: Unknowns::default(),
            busy: Mask::splat(false),
            indices: [LaneIndex::default(); W],
        }
    }
}

impl<const W: usize> LaneQueue<W> {
    /// Removes all problems and their contacts.
    pub fn clear(&mut self) {
        self.ncp.clear();
        self.z.clear(0);
        self.busy = Mask::splat(false);
    }

    /// Copies the problem `index` from one `lane` of problems and points side by side into a free
    /// lane, whose number it returns; there must be one.
    #[inline(always)]
    pub fn load<const V: usize>(
        &mut self,
        index: LaneIndex,
        ncp: &Ncp<V>,
        lane: usize,
        z: &Unknowns<V>,
    ) -> usize {
        let free = (0..W).find(|slot| !self.busy.lane(*slot));
        let slot = free.unwrap_or(W);
        assert!(slot < W, "none of {W} lanes is free for {index:?}");
        ncp.pack_lane(lane, &mut self.ncp, slot);
        self.z.resize(self.ncp.contacts.len());
        z.pack_lane(ncp, lane, &mut self.z, slot);
        self.busy.set(slot, true);
        self.indices[slot] = index;
        slot
    }
}
