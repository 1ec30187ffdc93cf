//! The oracles, on problems with known answers and on each other.

mod closed_loop;
mod compliant;
mod corpus;
mod enumeration;
mod hard_steps;
mod harvest;
mod residual;
