//! Stick or slide of the object on a body that it touches: [`ContactSlip`].

/// Posterior probabilities that the object touches a body and sticks to it or slides. The remainder
/// to 1 is the probability that it is apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSlip {
    /// Probability that it sticks or rolls: the surfaces do not move along each other.
    pub stick: f64,
    /// Probability that the object's surface slides to the left, seen from the body along the
    /// contact normal, which points into the object.
    pub left: f64,
    /// Probability that it slides to the right.
    pub right: f64,
}
