//! [`SolvedContact`].

use crate::input::Body;
use crate::ncp::problem::ContactPoint;

/// A contact of one particle after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedContact {
    /// The other body.
    pub body: Body,
    /// Where it is, at the beginning of the step.
    pub point: ContactPoint,
    /// Normal impulse over the step (N s).
    pub impulse: f64,
    /// Gap at the end of the step (m).
    pub gap: f64,
}
