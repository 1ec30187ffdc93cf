//! The narrow phase against independent answers: parry, brute force over directions, finite
//! differences, and laws of geometry.

mod engulfed;
mod errors;
mod fillets;
mod fuzz;
mod laws;
mod parry;
mod rates;
mod scenes;
mod shapes;
mod smooth;
mod unions;
