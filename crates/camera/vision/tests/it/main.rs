//! From frames to poses, on rendered rigs with known truth.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod calibration;
mod common;
mod pdf;
mod print;
mod tracking;
