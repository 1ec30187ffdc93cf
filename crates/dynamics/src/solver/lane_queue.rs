//! Problems from different chunks, side by side: [`Packed`].

use stickslip_lanes::Mask;

use crate::ncp::rows::Ncp;
use crate::ncp::unknowns::Impulses;

/// One particle of a block: which chunk of lanes, and which lane of it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Number of the chunk.
    pub chunk: usize,
    /// Lane of it.
    pub lane: usize,
}

/// Up to `W` problems, each in a lane of its own without the rows that padded it, with the point
/// that its solver has come to.
#[derive(Clone, Debug)]
pub struct Packed<const W: usize> {
    /// The problems.
    pub ncp: Ncp<W>,
    /// The points.
    pub p: Impulses<W>,
    /// Lanes with a problem.
    pub busy: Mask<W>,
    /// What the problem in each lane is called by who put it there.
    pub tags: [usize; W],
}

impl<const W: usize> Default for Packed<W> {
    fn default() -> Self {
        Self {
            ncp: Ncp::empty(),
            p: Impulses::zero(0),
            busy: Mask::splat(false),
            tags: [0; W],
        }
    }
}

impl<const W: usize> Packed<W> {
    /// Removes all problems and their contacts.
    pub fn clear(&mut self) {
        self.ncp.clear();
        self.p.clear(0);
        self.busy = Mask::splat(false);
    }

    /// Copies lane `lane` of a chunk into a free lane, whose number it returns; `None` where none
    /// is free.
    #[inline(always)]
    pub fn load(
        &mut self,
        ncp: &Ncp<W>,
        p: &Impulses<W>,
        lane: usize,
        tag: usize,
    ) -> Option<usize> {
        let slot = (0..W).find(|slot| !self.busy.lane(*slot))?;
        ncp.pack_lane(lane, &mut self.ncp, slot);
        self.p.resize(self.ncp.contacts.len());
        p.pack_lane(ncp, lane, &mut self.p, slot);
        self.busy.set(slot, true);
        self.tags[slot] = tag;
        Some(slot)
    }
}
