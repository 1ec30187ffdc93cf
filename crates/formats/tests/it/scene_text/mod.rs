//! Scene files as text, and the result of reading them.

use stickslip::Setup;
use stickslip_formats::read_scene;

pub mod lines;

/// Every key of the format, none with its default.
pub const FULL: &str = include_str!("../full_scene.toml");

/// Only the keys that have no default.
pub const LEAST: &str = "gravity = 9.81
[object]
mass = 1
inertia = 1e-3
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.3
tripod_radius = 0.02
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.3
[fixels]
friction = 0.25
";

pub fn read(text: &str) -> Setup {
    read_scene(text, "scene.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// Reads the full scene with `from` replaced by `to`; it must be refused at `place` with all of
/// `words`.
#[track_caller]
pub fn refused(from: &str, to: &str, place: &str, words: &[&str]) {
    refused_text(&replaced(FULL, from, to), place, words);
}

#[track_caller]
pub fn refused_text(text: &str, place: &str, words: &[&str]) {
    let message = read_scene(text, "scene.toml")
        .expect_err("must be refused")
        .to_string();
    assert!(
        message.starts_with(&format!("scene.toml:{place}: ")),
        "expected place {place}: {message}"
    );
    for word in words {
        assert!(message.contains(word), "expected `{word}`: {message}");
    }
}

#[track_caller]
pub fn replaced(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}` once");
    text.replace(from, to)
}
