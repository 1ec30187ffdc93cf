//! Random numbers of the rig, one stream for each thing that is random: [`RandomStream`].

use stickslip_filter::{Draw, Streams};

/// What is random about a rig.
#[derive(Clone, Copy, Debug)]
pub(super) enum RandomStream {
    /// Where the points of the support lie.
    Points,
    /// Load of each point.
    Roughness,
    /// How the load varies over the face.
    Pressure,
    /// How friction varies over the table.
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
