//! Experiments in small.

mod closed_loop;
mod harvest;
mod learned_friction;
