//! stickslip-testkit
