//! The friction parameters β of the model: [`Friction`].

use crate::se2::fields;

/// The four friction parameters β, or one thing per parameter: its limits, its noise, whether it
/// took part in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction<T = f64> {
    /// μ_s, object–support.
    pub mu_s: T,
    /// μ_p, object–pusher.
    pub mu_p: T,
    /// μ_f, object–fixel.
    pub mu_f: T,
    /// Radius of the support tripod (m); unused where the feet are known.
    pub d_tri: T,
}

fields!(Friction, 4: mu_s, mu_p, mu_f, d_tri);
