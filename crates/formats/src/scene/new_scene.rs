//! The scene to begin with: [`NEW_SCENE`].

/// A `scene.toml` with every key explained, to be filled in with one's own numbers; values that may
/// be left out stand behind `#`. It can be read as it is.
pub const NEW_SCENE: &str = include_str!("new_scene.toml");
