//! The dynamics against closed forms, other programs, laws of physics and recorded data.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod certificate;
mod closed_forms;
mod common;
mod cone_program;
mod corpus;
mod energy;
mod hand;
mod invariance;
mod jam;
mod lanes;
mod modes;
mod narrow_phase;
mod offsets;
mod reference_trajectory;
mod rollout;
mod stalled_pusher;
