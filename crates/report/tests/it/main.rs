//! Figures and pages.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod browser;
mod common;
#[cfg(feature = "png")]
mod figures;
mod page;
