//! Filters and smoothers against exact answers.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod allocation;
mod bridge;
mod bystander;
mod collapse;
mod common;
mod imm;
mod kalman;
mod least_moved;
mod linear_gaussian;
mod particle_set;
mod resampling;
mod streams;
mod threads;
mod weights;
