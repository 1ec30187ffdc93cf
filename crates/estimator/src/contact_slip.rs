//! How the object moves along a body that it touches: [`ContactSlip`].

/// Posterior probabilities that the object touches a body and sticks to it or slides; what is left
/// of 1 is that it is apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSlip {
    /// That it sticks, or rolls: the surfaces do not move along each other.
    pub stick: f64,
    /// That the object's surface slides to the left, seen from the body along the contact normal,
    /// which points into the object.
    pub left: f64,
    /// That it slides to the right.
    pub right: f64,
}
