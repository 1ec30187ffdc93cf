//! Random numbers of the rig, one stream for each thing that is random: [`RandomStream`].

use stickslip_filter::{Draw, Streams};

/// Random quantity of a rig.
#[derive(Clone, Copy, Debug)]
pub(super) enum RandomStream {
    /// Positions of the support's points.
    Points,
    /// Load of each point.
    Roughness,
    /// Variation of the load over the face.
    Pressure,
    /// Variation of friction over the table.
    Table,
    /// Phases of the drive's ripple.
    Drive,
}

impl RandomStream {
    /// The numbers of this stream under a seed.
    pub(super) fn draw(self, seed: u64) -> Draw {
        Streams::new(seed).at(self as u64)
    }
}
