//! The oracles, on problems with known answers and on each other.

mod compliant;
mod corpus;
mod enumeration;
mod hard_steps;
mod residual;
