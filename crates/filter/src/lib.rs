//! Particle filtering.
