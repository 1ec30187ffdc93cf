//! The scene to begin with: [`NEW_SCENE`].

/// A `scene.toml` with every key, its unit, its default and its meaning; optional lines are
/// comments. It can be read as it is.
pub const NEW_SCENE: &str = include_str!("new_scene.toml");
