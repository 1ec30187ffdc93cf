//! Creep of contacts (docs/method.md (50)): [`creep`].

use stickslip_lanes::Lanes;

use crate::ncp::rows::FootRow;
use crate::se2::Twist;

/// Share of the feet's friction with which a contact counts as pressed at least: the load of a new
/// contact is not known.
const LEAST_LOAD: f64 = 0.1;

/// Least friction bound of a contact, and of the feet together (m/s): keeps quotients finite.
const LEAST_BOUND: f64 = 1e-9;

/// Creep c of a contact that pressed with `p_n` in the step before. Its friction reaches its bound
/// at `slip`, or below where it is pressed harder than all `feet` resist (all m/s).
#[inline(always)]
pub(crate) fn creep<const W: usize>(
    slip: Lanes<W>,
    mu: Lanes<W>,
    p_n: Lanes<W>,
    feet: &[FootRow<W>; 3],
) -> Lanes<W> {
    let feet = (feet[0].bound + feet[1].bound + feet[2].bound).max(Lanes::splat(LEAST_BOUND));
    let pressed = p_n.max(feet * LEAST_LOAD);
    let bound = (mu * pressed).max(Lanes::splat(LEAST_BOUND));
    slip * (feet / (feet.max(p_n) * bound))
}

/// Speed of an object, mass-normalised (m/s).
#[inline(always)]
pub(crate) fn speed<const W: usize>(
    Twist { vx, vy, omega }: &Twist<Lanes<W>>,
    rho: f64,
) -> Lanes<W> {
    let turn = *omega * rho;
    (*vx * *vx + *vy * *vy + turn * turn).sqrt()
}
