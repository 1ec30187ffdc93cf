//! The gap of two bodies: [`gap`].

use stickslip_dynamics::{Placed, narrow_phase};

/// Returns the gap between an object and another body (m), however far apart they are. A negative
/// gap is an overlap.
pub(crate) fn gap(object: &Placed<'_>, other: &Placed<'_>) -> Option<f64> {
    let mut gaps = Vec::new();
    narrow_phase(object, other, f64::INFINITY, &mut gaps);
    gaps.iter().map(|gap| gap.gap).min_by(f64::total_cmp)
}
