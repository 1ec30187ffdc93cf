//! The smoothed NCP at one point, [`SmoothedMap`], and its linearisation.
//!
//! Every row depends smoothly on a speed ε, and at ε = 0 it is the NCP itself. Complementarity
//! pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993); friction becomes
//! bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the primal–dual form of
//! Andersen, Christiansen, Conn & Overton 2000).

use stickslip_lanes::Lanes;

use crate::ncp::max_abs::MaxAbs;
use crate::ncp::rows::{ContactRow, FootRow, Ncp, ROOM, square};
use crate::ncp::unknowns::Unknowns;
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};

/// Largest stiffness of a smoothed row.
const STIFFEST: f64 = 1.0e13;

/// The smoothed rows at one point and ε, with the intermediate numbers that their linearisation
/// needs too.
#[derive(Clone, Debug)]
pub struct SmoothedMap<const W: usize> {
    epsilon: Lanes<W>,
    feet: [SmoothedFoot<W>; 3],
    contacts: Vec<SmoothedContact<W>>,
    stall: SmoothedPair<W>,
}

/// Friction of one foot.
#[derive(Clone, Copy, Debug, Default)]
struct SmoothedFoot<const W: usize> {
    slip: [Lanes<W>; 2],
    /// 1/σ.
    inv_sigma: Lanes<W>,
}

/// One contact.
#[derive(Clone, Copy, Debug)]
struct SmoothedContact<const W: usize> {
    pair: SmoothedPair<W>,
    slip: Lanes<W>,
    /// 1/σ.
    inv_sigma: Lanes<W>,
}

/// A pair a ⟂ b.
#[derive(Clone, Copy, Debug, Default)]
struct SmoothedPair<const W: usize> {
    /// a − b.
    difference: Lanes<W>,
    /// sqrt((a − b)² + 4ε²).
    root: Lanes<W>,
    /// a + b less the root.
    value: Lanes<W>,
}

impl<const W: usize> Default for SmoothedMap<W> {
    fn default() -> Self {
        Self {
            epsilon: Lanes::ZERO,
            feet: [SmoothedFoot::default(); 3],
            contacts: Vec::with_capacity(ROOM),
            stall: SmoothedPair::default(),
        }
    }
}

impl<const W: usize> SmoothedMap<W> {
    /// Evaluates the rows at `z`, smoothed with `epsilon`; returns the largest violation (m/s).
    #[inline(always)]
    pub fn evaluate(&mut self, ncp: &Ncp<W>, z: &Unknowns<W>, epsilon: Lanes<W>) -> Lanes<W> {
        self.epsilon = epsilon;
        let squared = epsilon * epsilon;
        let mut largest = MaxAbs::ZERO;
        // contacts
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(z.contacts()) {
            let gap = row.gap_velocity(&z.v, z.pusher_yield) + ncp.compliance * *p_n;
            let pair = SmoothedPair::new(*p_n, gap, squared);
            let slip = row.slip_velocity(&z.v, z.pusher_yield);
            let inv_sigma = squared.add_mul(slip, slip).inverse_sqrt();
            largest.accumulate(pair.value);
            largest.accumulate(p_t.add_mul(row.mu * p_n.max(Lanes::ZERO), slip * inv_sigma));
            self.contacts.push(SmoothedContact {
                pair,
                slip,
                inv_sigma,
            });
        }
        // feet: one root for the largest of their squared lengths
        let mut squares = MaxAbs::ZERO;
        for (map, (foot, p_k)) in self.feet.iter_mut().zip(ncp.feet.iter().zip(&z.feet)) {
            let slip = foot.slip(&z.v);
            let inv_sigma = squared
                .add_mul(slip[0], slip[0])
                .add_mul(slip[1], slip[1])
                .inverse_sqrt();
            let violation = [
                p_k[0].add_mul(foot.bound, slip[0] * inv_sigma),
                p_k[1].add_mul(foot.bound, slip[1] * inv_sigma),
            ];
            squares.accumulate(square(&violation));
            *map = SmoothedFoot { slip, inv_sigma };
        }
        largest.accumulate(squares.sqrt());
        // the stall pair of pushers that may stall
        let finite = ncp.stall.lt(Lanes::splat(f64::INFINITY));
        self.stall = SmoothedPair::new(
            finite.zero_unless(ncp.stall) - ncp.resistance(z),
            z.pusher_yield,
            squared,
        );
        largest.accumulate(finite.zero_unless(self.stall.value));
        largest.value()
    }
}

impl<const W: usize> SmoothedPair<W> {
    #[inline(always)]
    fn new(a: Lanes<W>, b: Lanes<W>, epsilon_squared: Lanes<W>) -> Self {
        let difference = a - b;
        let root = (epsilon_squared * 4.0)
            .add_mul(difference, difference)
            .sqrt();
        Self {
            difference,
            root,
            value: a + b - root,
        }
    }

    /// Linearised in a, b and ε, towards the target ε.
    #[inline(always)]
    fn linearised(&self, aim: &Aim<W>) -> LinearPair<W> {
        let Self {
            difference,
            root,
            value,
        } = *self;
        let sum = root + difference.abs();
        let inverse = Lanes::splat(1.0) / (root * sum);
        // 1 − |a − b| / root without cancellation
        let less = aim.epsilon * aim.epsilon * 4.0 * inverse;
        let more = Lanes::splat(2.0) - less;
        let forward = difference.gt(Lanes::ZERO);
        let value = value - aim.epsilon * 4.0 * (inverse * sum) * (aim.target - aim.epsilon);
        LinearPair {
            a: forward.select(less, more),
            b: forward.select(more, less),
            value,
        }
    }
}

/// A smoothed pair a ⟂ b, linearised: a da + b db = −value.
struct LinearPair<const W: usize> {
    /// Coefficient of da.
    a: Lanes<W>,
    /// Coefficient of db.
    b: Lanes<W>,
    /// The value that da and db make up for.
    value: Lanes<W>,
}

impl<const W: usize> Linearised<W> {
    /// The smoothed rows at `z`, where they are `map`, linearised in the unknowns and ε, towards ε
    /// = `target`.
    #[inline(always)]
    pub fn linearise_smoothed_map(
        &mut self,
        ncp: &Ncp<W>,
        z: &Unknowns<W>,
        map: &SmoothedMap<W>,
        target: Lanes<W>,
    ) {
        let aim = Aim {
            epsilon: map.epsilon,
            target,
        };
        self.imbalance = ncp.imbalance(z);
        self.contacts.clear();
        let points = map.contacts.iter().zip(z.contacts());
        for (i, (row, (contact, (p_n, p_t)))) in ncp.contacts.iter().zip(points).enumerate() {
            let step = aim.contact(row, contact, [*p_n, *p_t], ncp.compliance);
            self.contacts.push((i, step));
        }
        let ([a, b, c], [map_a, map_b, map_c]) = (&ncp.feet, &map.feet);
        // no loop, as in `Linearised::apply`
        self.feet = [
            aim.foot(a, map_a, &z.feet[0]),
            aim.foot(b, map_b, &z.feet[1]),
            aim.foot(c, map_c, &z.feet[2]),
        ];
        self.stall = aim.stall(ncp, &map.stall, z.pusher_yield);
    }
}

/// ε at which the rows are linearised, and the ε that the step is to reach.
struct Aim<const W: usize> {
    epsilon: Lanes<W>,
    target: Lanes<W>,
}

impl<const W: usize> Aim<W> {
    /// σ extrapolated linearly to the target, over σ.
    #[inline(always)]
    fn sigma_ratio(&self, inv_sigma: Lanes<W>) -> Lanes<W> {
        Lanes::splat(1.0) + self.epsilon * (self.target - self.epsilon) * inv_sigma * inv_sigma
    }

    #[inline(always)]
    fn contact(
        &self,
        row: &ContactRow<W>,
        map: &SmoothedContact<W>,
        p: [Lanes<W>; 2],
        compliance: Lanes<W>,
    ) -> ContactStep<W> {
        let pair = map.pair.linearised(self);
        // γ itself grows by κ dp_n
        let weight =
            Lanes::splat(1.0) / (pair.a.max(Lanes::splat(2.0 / STIFFEST)) + compliance * pair.b);
        let (r_n, nn) = (-pair.value * weight, pair.b * weight);

        let inv_sigma = map.inv_sigma;
        let bound = row.mu * p[0].max(Lanes::ZERO);
        let unit = map.slip * inv_sigma;
        // the matrix uses p_t clamped to the cone, which keeps its diagonal positive
        let clamped = p[1].min(bound).max(-bound);
        let tt = ((bound + clamped * unit) * inv_sigma).min(Lanes::splat(STIFFEST));
        let ratio = p[0].gt(Lanes::ZERO).zero_unless(-row.mu * unit);
        ContactStep {
            n: r_n,
            t: ratio * r_n - (bound * unit + p[1] * self.sigma_ratio(inv_sigma)),
            nn,
            tn: ratio * nn,
            tt,
        }
    }

    #[inline(always)]
    fn foot(&self, foot: &FootRow<W>, map: &SmoothedFoot<W>, p: &[Lanes<W>; 2]) -> FootStep<W> {
        let SmoothedFoot { slip, inv_sigma } = *map;
        let ratio = self.sigma_ratio(inv_sigma);
        let unit = [slip[0] * inv_sigma, slip[1] * inv_sigma];
        let size = square(p).sqrt();
        let outside = size.gt(foot.bound);
        let one = Lanes::splat(1.0);
        let shrink = outside.select(foot.bound / outside.select(size, one), one) * inv_sigma;
        let inside = [p[0] * shrink, p[1] * shrink];
        let bound = foot.bound * inv_sigma;
        FootStep {
            r: [
                -(foot.bound * unit[0] + p[0] * ratio),
                -(foot.bound * unit[1] + p[1] * ratio),
            ],
            k: [
                [bound + inside[0] * unit[0], inside[0] * unit[1]],
                [inside[1] * unit[0], bound + inside[1] * unit[1]],
            ],
        }
    }

    #[inline(always)]
    fn stall(&self, ncp: &Ncp<W>, map: &SmoothedPair<W>, pusher_yield: Lanes<W>) -> StallStep<W> {
        let finite = ncp.stall.lt(Lanes::splat(f64::INFINITY));
        let pair = map.linearised(self);
        let one = Lanes::splat(1.0);
        StallStep {
            slack: finite.zero_unless(pair.a),
            pusher: finite.select(pair.b, one),
            rhs: -finite.select(pair.value, pusher_yield),
        }
    }
}
