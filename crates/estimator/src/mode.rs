//! Rules of the particle filter: [`Mode`].

/// Rules of the particle filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Mode {
    /// What a scene does not know exactly is unknown to the particles, too
    /// ([`Uncertainty`](crate::Uncertainty)); sensors may fail for a while, and the camera may be
    /// wrong now and then.
    #[default]
    Contact,
    /// The rules of Zhang & Trinkle (ICRA 2012), for comparison.
    Paper,
}
