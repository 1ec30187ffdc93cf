//! Kinds of random scenes, by the situation of the object: [`SceneKind`].

/// Layout of the bodies of a random scene. The push goes along +x of the scene's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SceneKind {
    /// An ordinary push, past a fixel that the object grazes.
    Graze,
    /// Against one or two fixels ahead, more or less head on.
    Stop,
    /// About a fixel that one side of the object meets, pushed on the other.
    Pivot,
    /// Between two fixels whose normals close like a wedge, at the angle of self-locking friction
    /// and around it.
    Wedge,
    /// Along two parallel walls with little room, pushed off-centre.
    Corridor,
    /// Into a slot that is a little too narrow.
    Slot,
    /// Amid three to six fixels around the object: form closures and nearly so.
    FormClosure,
    /// A face of the pusher flat against a face of the object, which goes flat against a wall.
    FaceToFace,
    /// Corners that meet corners head on.
    Corner,
    /// Up to six fixels anywhere on the way.
    Clutter,
}

impl SceneKind {
    /// All kinds, in the order in which scenes cycle through them.
    pub const ALL: [Self; 10] = [
        Self::Graze,
        Self::Stop,
        Self::Pivot,
        Self::Wedge,
        Self::Corridor,
        Self::Slot,
        Self::FormClosure,
        Self::FaceToFace,
        Self::Corner,
        Self::Clutter,
    ];

    /// The kind of scene `index`.
    #[must_use]
    pub fn of(index: u64) -> Self {
        Self::ALL[(index % Self::ALL.len() as u64) as usize]
    }
}
