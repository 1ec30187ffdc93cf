//! One of the places where the object may be: [`BeliefMode`].

use stickslip_dynamics::Pose;

/// A group of particles that lies apart from the others.
///
/// Where the object can go either way, past a fixel on its left or on its right, the mean of the
/// particles lies between the two, where the object is not; each way is a mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeliefMode {
    /// Share of the belief, from 0 to 1.
    pub weight: f64,
    /// Pose (m, m, rad) of the particle nearest to the mean of the mode: one that the dynamics
    /// allows, so that the object there overlaps nothing, given where that particle takes the
    /// bodies to be.
    pub pose: Pose,
    /// Standard deviations about the mean of the mode (m, m, rad).
    pub std: Pose,
}
