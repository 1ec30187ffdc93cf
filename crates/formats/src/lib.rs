//! stickslip-formats
