//! stickslip
fn main() {}
