//! Configuration of the particle filter: [`FilterModel`].

/// Configuration of the particle filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum FilterModel {
    /// Friction, support feet, frame offsets and latency are unknown to the particles
    /// ([`Uncertainty`](crate::Uncertainty)). Touch sensors may fail for a while, and a camera pose
    /// may be an outlier.
    #[default]
    Robust,
    /// The rules of Zhang & Trinkle (ICRA 2012), for comparison.
    Paper,
}
