//! Modes of a contact, [`ContactMode`], and its linear model in a given mode.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::natural_map::ContactVelocity;
use crate::ncp::rows::ContactRow;
use crate::solver::linearised::ContactStep;

/// Weight of a contact's impulse against its slip where the natural map chooses between sticking
/// and sliding, in units of the inertia that resists the slip.
const IMPULSE_WEIGHT: f64 = 4.0;

/// Open, sticking, or sliding either way.
#[derive(Clone, Copy, Debug)]
pub struct ContactMode<const W: usize> {
    /// Its gap is active: driven to zero.
    pub closed: Mask<W>,
    /// p_t = ratio p_n; else its slip is active too, where it is closed.
    pub sliding: Mask<W>,
    /// ±μ.
    pub ratio: Lanes<W>,
}

impl<const W: usize> ContactMode<W> {
    /// The mode that the natural map chooses at impulses (p_n, p_t); `None` where the contact is
    /// open and carries nothing in every lane.
    #[inline(always)]
    pub fn by_natural_map(
        row: &ContactRow<W>,
        p: [Lanes<W>; 2],
        velocity: &ContactVelocity<W>,
    ) -> Option<Self> {
        let one = Lanes::splat(1.0);
        let closed = (p[0] * one.add_mul(row.n[2], row.n[2])).gt(velocity.gap);
        if !(closed.any() || (p[0].abs() + p[1].abs()).gt(Lanes::ZERO).any()) {
            return None;
        }
        let inertia = one.add_mul(row.t[2], row.t[2]) * IMPULSE_WEIGHT;
        let z = (-velocity.slip).add_mul(p[1], inertia);
        Some(Self {
            closed,
            sliding: z.abs().gt(row.mu * p[0].max(Lanes::ZERO) * inertia),
            ratio: z.sign() * row.mu,
        })
    }

    /// The mode that the impulses themselves show, closed where p_n exceeds the gap velocity; an
    /// impulse above the share `sliding` of its bound slides.
    #[inline(always)]
    pub fn by_impulses(
        row: &ContactRow<W>,
        p: [Lanes<W>; 2],
        gap_velocity: Lanes<W>,
        sliding: f64,
    ) -> Self {
        Self {
            closed: p[0].gt(gap_velocity),
            sliding: p[1].abs().gt(row.mu * p[0] * sliding),
            ratio: p[1].sign() * row.mu,
        }
    }
}

/// Penalty stiffness of a contact's active rows, in units of the object's mass per step.
#[derive(Clone, Copy, Debug)]
pub struct Penalty<const W: usize> {
    gap: Lanes<W>,
    slip: Lanes<W>,
}

impl<const W: usize> Penalty<W> {
    /// `stiffness` k, in the gap row in series with its compliance κ: k / (1 + κ k).
    #[inline(always)]
    pub fn new(stiffness: Lanes<W>, compliance: Lanes<W>) -> Self {
        // a division only where some problem is compliant
        let gap = if compliance.gt(Lanes::ZERO).any() {
            stiffness / Lanes::splat(1.0).add_mul(compliance, stiffness)
        } else {
            stiffness
        };
        Self {
            gap,
            slip: stiffness,
        }
    }
}

impl<const W: usize> ContactStep<W> {
    /// A contact of impulses (p_n, p_t) in a given mode.
    #[inline(always)]
    pub fn in_mode(
        p: [Lanes<W>; 2],
        velocity: &ContactVelocity<W>,
        mode: ContactMode<W>,
        penalty: &Penalty<W>,
    ) -> Self {
        let n = mode.closed.select(-velocity.gap * penalty.gap, -p[0]);
        let nn = mode.closed.zero_unless(penalty.gap);
        let free = mode.sliding | !mode.closed;
        Self {
            n,
            t: free.select(
                (-p[1]).add_mul(mode.ratio, p[0] + n),
                -velocity.slip * penalty.slip,
            ),
            nn,
            tn: free.zero_unless(mode.ratio * nn),
            tt: free.select(Lanes::ZERO, penalty.slip),
        }
    }
}
