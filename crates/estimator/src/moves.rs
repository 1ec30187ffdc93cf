//! What brings particles to where weighing alone would leave few: [`Moves`].

/// What contact mode does with particles beside weighing and resampling (docs/method.md, (42) to
/// (45)); by default all. Without any of it very many particles are needed for the same belief;
/// paper mode has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moves {
    /// Steps since a blackout that explain touch and pusher too badly are made again (42).
    pub second_tries: bool,
    /// Latency is exchanged for the pusher's offset under a steady push (43).
    pub steady_push: bool,
    /// The pose of an object that waits is drawn anew from what all camera poses add up to (44).
    pub waiting: bool,
    /// A camera pose that would leave few particles moves them, too (45).
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
