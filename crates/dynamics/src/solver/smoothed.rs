//! The smoothed NCP: every row depends smoothly on a speed ε, and at ε = 0 it is the NCP itself.
//!
//! Complementarity pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993),
//! friction becomes bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the
//! primal–dual form of Andersen, Christiansen, Conn & Overton 2000).

use stickslip_lanes::Lanes;

use crate::ncp::rows::{ContactRow, FootRow, Ncp, ROOM, Worst, square};
use crate::ncp::unknowns::Impulses;
use crate::solver::linearised::{ContactStep, FootStep, Linearised, StallStep};

/// Largest stiffness a smoothed row may reach.
const STIFFEST: f64 = 1.0e13;

/// The smoothed rows at one point and ε, with what leads to them.
#[derive(Clone, Debug)]
pub struct SmoothedMap<const W: usize> {
    epsilon: Lanes<W>,
    feet: [SmoothedFoot<W>; 3],
    contacts: Vec<SmoothedContact<W>>,
    stall: SmoothedPair<W>,
}

/// Friction of one foot.
#[derive(Clone, Copy, Debug)]
struct SmoothedFoot<const W: usize> {
    slip: [Lanes<W>; 2],
    /// 1/σ.
    inverse: Lanes<W>,
}

/// One contact.
#[derive(Clone, Copy, Debug)]
struct SmoothedContact<const W: usize> {
    pair: SmoothedPair<W>,
    slip: Lanes<W>,
    /// 1/σ.
    inverse: Lanes<W>,
}

/// A pair a ⟂ b: a − b, the root sqrt((a − b)² + 4ε²), and a + b less the root.
#[derive(Clone, Copy, Debug)]
struct SmoothedPair<const W: usize> {
    difference: Lanes<W>,
    root: Lanes<W>,
    value: Lanes<W>,
}

impl<const W: usize> Default for SmoothedMap<W> {
    fn default() -> Self {
        let o = Lanes::ZERO;
        let foot = SmoothedFoot {
            slip: [o; 2],
            inverse: o,
        };
        Self {
            epsilon: o,
            feet: [foot; 3],
            contacts: Vec::with_capacity(ROOM),
            stall: SmoothedPair {
                difference: o,
                root: o,
                value: o,
            },
        }
    }
}

impl<const W: usize> SmoothedMap<W> {
    /// Takes the rows at `p`, smoothed with `epsilon`; returns the largest violation (m/s).
    #[inline(always)]
    pub fn take(&mut self, ncp: &Ncp<W>, p: &Impulses<W>, epsilon: Lanes<W>) -> Lanes<W> {
        self.epsilon = epsilon;
        let squared = epsilon * epsilon;
        let mut worst = Worst::NONE;
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gap = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
            let pair = SmoothedPair::new(*p_n, gap, squared);
            let slip = row.slip_velocity(&p.v, p.pusher_yield);
            let inverse = squared.add_mul(slip, slip).inverse_sqrt();
            worst.note(pair.value);
            worst.note(p_t.add_mul(row.mu * p_n.max(Lanes::ZERO), slip * inverse));
            self.contacts.push(SmoothedContact {
                pair,
                slip,
                inverse,
            });
        }
        let mut squares = Worst::NONE;
        for (map, (foot, p_k)) in self.feet.iter_mut().zip(ncp.feet.iter().zip(&p.feet)) {
            let slip = foot.slip(&p.v);
            let inverse = squared
                .add_mul(slip[0], slip[0])
                .add_mul(slip[1], slip[1])
                .inverse_sqrt();
            let off = [
                p_k[0].add_mul(foot.bound, slip[0] * inverse),
                p_k[1].add_mul(foot.bound, slip[1] * inverse),
            ];
            squares.note(square(&off));
            *map = SmoothedFoot { slip, inverse };
        }
        let finite = ncp.stall.lt(Lanes::splat(f64::INFINITY));
        self.stall = SmoothedPair::new(
            finite.zero_unless(ncp.stall) - ncp.resistance(p),
            p.pusher_yield,
            squared,
        );
        worst.note(squares.root());
        worst.note(finite.zero_unless(self.stall.value));
        worst.size()
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

    /// Linearised in a, b and ε, and aimed at another ε.
    #[inline(always)]
    fn linearised(&self, aim: &Aim<W>) -> Pair<W> {
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
        Pair {
            a: forward.select(less, more),
            b: forward.select(more, less),
            value,
        }
    }
}

/// A smoothed pair a ⟂ b, linearised.
struct Pair<const W: usize> {
    /// Coefficient of da.
    a: Lanes<W>,
    /// Coefficient of db.
    b: Lanes<W>,
    /// The value that da and db have to undo.
    value: Lanes<W>,
}

impl<const W: usize> Linearised<W> {
    /// The smoothed rows at `p`, where they are `map`, linearised in unknowns and ε and aimed at ε
    /// = `target`.
    #[inline(always)]
    pub fn smoothed(
        &mut self,
        ncp: &Ncp<W>,
        p: &Impulses<W>,
        map: &SmoothedMap<W>,
        target: Lanes<W>,
    ) {
        let aim = Aim {
            epsilon: map.epsilon,
            target,
        };
        self.imbalance = ncp.imbalance(p);
        self.contacts.clear();
        let points = p.normal.iter().zip(&p.tangential);
        for (i, ((row, contact), (p_n, p_t))) in ncp
            .contacts
            .iter()
            .zip(&map.contacts)
            .zip(points)
            .enumerate()
        {
            self.contacts
                .push((i, aim.contact(row, contact, [*p_n, *p_t], ncp.compliance)));
        }
        let ([a, b, c], [map_a, map_b, map_c]) = (&ncp.feet, &map.feet);
        // no loop, as in `Linearised::take_step`
        self.feet = [
            aim.foot(a, map_a, &p.feet[0]),
            aim.foot(b, map_b, &p.feet[1]),
            aim.foot(c, map_c, &p.feet[2]),
        ];
        self.stall = aim.stall(ncp, &map.stall, p.pusher_yield);
    }
}

/// Where a linearisation is taken and where it shall lead.
struct Aim<const W: usize> {
    epsilon: Lanes<W>,
    target: Lanes<W>,
}

impl<const W: usize> Aim<W> {
    /// σ linearised at the target, over σ, for 1/σ.
    #[inline(always)]
    fn shift(&self, inverse: Lanes<W>) -> Lanes<W> {
        Lanes::splat(1.0) + self.epsilon * (self.target - self.epsilon) * inverse * inverse
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

        let inverse = map.inverse;
        let bound = row.mu * p[0].max(Lanes::ZERO);
        let unit = map.slip * inverse;
        // the matrix uses p_t clamped to the cone, which keeps its diagonal positive
        let clamped = p[1].min(bound).max(-bound);
        let tt = ((bound + clamped * unit) * inverse).min(Lanes::splat(STIFFEST));
        let ratio = p[0].gt(Lanes::ZERO).zero_unless(-row.mu * unit);
        ContactStep {
            n: r_n,
            t: ratio * r_n - (bound * unit + p[1] * self.shift(inverse)),
            nn,
            tn: ratio * nn,
            tt,
        }
    }

    #[inline(always)]
    fn foot(&self, foot: &FootRow<W>, map: &SmoothedFoot<W>, p: &[Lanes<W>; 2]) -> FootStep<W> {
        let SmoothedFoot { slip, inverse } = *map;
        let shift = self.shift(inverse);
        let unit = [slip[0] * inverse, slip[1] * inverse];
        let size = square(p).sqrt();
        let outside = size.gt(foot.bound);
        let one = Lanes::splat(1.0);
        let shrink = outside.select(foot.bound / outside.select(size, one), one) * inverse;
        let inside = [p[0] * shrink, p[1] * shrink];
        let bound = foot.bound * inverse;
        FootStep {
            r: [
                -(foot.bound * unit[0] + p[0] * shift),
                -(foot.bound * unit[1] + p[1] * shift),
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
