//! Ways to move particles to where weighing alone would leave few: [`Moves`].

/// Ways in which the robust model moves particles, in addition to weighing and resampling
/// (docs/method.md, (42) to (45)). All are on by default. Without any one of them, the same belief
/// needs very many particles. The paper's model has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moves {
    /// Re-simulation of the steps since an occlusion began, if they explain touch and pusher too
    /// badly (42).
    pub second_tries: bool,
    /// Exchange of latency for pusher offset under a steady push (43).
    pub steady_push: bool,
    /// Redrawing the pose of an object that waits, from the belief that all camera poses add up to
    /// (44).
    pub waiting: bool,
    /// Ensemble update by a camera pose that would leave few particles (45).
    pub camera: bool,
}

impl Default for Moves {
    fn default() -> Self {
        Self {
            second_tries: true,
            steady_push: true,
            waiting: true,
            camera: true,
        }
    }
}
