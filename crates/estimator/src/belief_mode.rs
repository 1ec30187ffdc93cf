//! One peak of the belief about the object's pose: [`BeliefMode`].

use stickslip_dynamics::Pose;

/// A group of particles that lies apart from the others.
///
/// At a bifurcation the object can pass a fixel on its left or on its right. The mean of the
/// particles then lies between the two ways, where the object cannot be. Each way is a mode of its
/// own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeliefMode {
    /// Share of the belief, from 0 to 1.
    pub weight: f64,
    /// Pose (m, m, rad) of the particle nearest to the mean of the mode. The dynamics allows this
    /// pose: the object there overlaps no body as that particle places them.
    pub pose: Pose,
    /// Standard deviations about the mean of the mode (m, m, rad).
    pub std: Pose,
}
