//! Ways to move particles to where weighing alone would leave few: [`Moves`].

/// Ways in which the robust model moves particles, in addition to weighing and resampling
/// (docs/model.md, (42) and (45)). Both are on by default. The paper's model has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moves {
    /// Re-simulation of the steps since an occlusion began, if they explain touch and pusher too
    /// badly (42).
    pub second_tries: bool,
    /// Ensemble update by camera poses (45).
    pub camera: bool,
}

impl Default for Moves {
    fn default() -> Self {
        Self {
            second_tries: true,
            camera: true,
        }
    }
}
