//! Learning from pushes whose constants are known.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;
mod geometry;
mod prediction;
mod recovery;
