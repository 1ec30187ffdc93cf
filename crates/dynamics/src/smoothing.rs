//! The smoothed NCP: every row depends smoothly on a speed ε, and at ε = 0 it is the NCP itself.
//!
//! Complementarity pairs a ⟂ b become a + b − sqrt((a − b)² + 4ε²) = 0 (Chen & Harker 1993), friction becomes
//! bound·s + p σ = 0 with σ = sqrt(|s|² + ε²), linearised as it stands (the primal–dual form of Andersen, Christiansen, Conn &
//! Overton 2000).

use crate::condensed::{ContactStep, FootStep, Linearised, StallStep};
use crate::impulses::Impulses;
use crate::lanes::Lanes;
use crate::ncp::{ContactRow, FootRow, Ncp, Triple, worse};

/// Largest stiffness a smoothed row may reach.
const STIFFEST: f64 = 1.0e13;

impl<const W: usize> Ncp<W> {
    /// Largest violation of the rows smoothed with ε (m/s).
    #[inline(always)]
    pub fn smoothed_residual(&self, p: &Impulses<W>, epsilon: Lanes<W>) -> Lanes<W> {
        let mut worst = Lanes::ZERO;
        let squared = epsilon * epsilon;
        for (row, (p_n, p_t)) in self.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gap = row.gap_velocity(&p.v, p.pusher_yield) + self.compliance * *p_n;
            worst = worse(worst, smooth_pair(*p_n, gap, squared));
            let s = row.slip_velocity(&p.v, p.pusher_yield);
            let sigma = (s * s + squared).sqrt();
            worst = worse(worst, row.mu * p_n.max(Lanes::ZERO) * s / sigma + *p_t);
        }
        for (foot, p_k) in self.feet.iter().zip(&p.feet) {
            let s = foot.slip(&p.v);
            let share = foot.bound / (s[0] * s[0] + s[1] * s[1] + squared).sqrt();
            let off = [share * s[0] + p_k[0], share * s[1] + p_k[1]];
            worst = worse(worst, (off[0] * off[0] + off[1] * off[1]).sqrt());
        }
        let finite = self.stall.lt(Lanes::splat(f64::INFINITY));
        worse(worst, finite.keep(smooth_pair(self.stall - self.resistance(p), p.pusher_yield, squared)))
    }
}

/// a + b − sqrt((a − b)² + 4ε²).
#[inline(always)]
fn smooth_pair<const W: usize>(a: Lanes<W>, b: Lanes<W>, epsilon_squared: Lanes<W>) -> Lanes<W> {
    a + b - ((a - b) * (a - b) + epsilon_squared * 4.0).sqrt()
}

/// A smoothed pair a ⟂ b at ε, linearised in both and aimed at ε = `target`.
struct Pair<const W: usize> {
    /// Coefficient of da.
    a: Lanes<W>,
    /// Coefficient of db.
    b: Lanes<W>,
    /// The value that da and db have to undo.
    value: Lanes<W>,
}

impl<const W: usize> Pair<W> {
    #[inline(always)]
    fn new(a: Lanes<W>, b: Lanes<W>, aim: &Aim<W>) -> Self {
        let difference = a - b;
        let squared = aim.epsilon * aim.epsilon * 4.0;
        let root = (difference * difference + squared).sqrt();
        let inverse = Lanes::splat(1.0) / root;
        // 1 − |w| without cancellation
        let less = squared * inverse / (root + difference.abs());
        let more = Lanes::splat(2.0) - less;
        let forward = difference.gt(Lanes::ZERO);
        let value = a + b - root - aim.epsilon * 4.0 * inverse * (aim.target - aim.epsilon);
        Self { a: forward.select(less, more), b: forward.select(more, less), value }
    }
}

impl<const W: usize> Linearised<W> {
    /// All rows, smoothed with ε and linearised at `p` in unknowns and ε, aimed at ε = `target`.
    #[inline(always)]
    pub fn smoothed(&mut self, ncp: &Ncp<W>, p: &Impulses<W>, epsilon: Lanes<W>, target: Lanes<W>) {
        let aim = Aim { epsilon, target };
        self.contacts.clear();
        for (row, (p_n, p_t)) in ncp.contacts.iter().zip(p.normal.iter().zip(&p.tangential)) {
            let gamma = row.gap_velocity(&p.v, p.pusher_yield) + ncp.compliance * *p_n;
            let slip = row.slip_velocity(&p.v, p.pusher_yield);
            self.contacts.push(aim.contact(row, [*p_n, *p_t], [gamma, slip], ncp.compliance));
        }
        for (step, (foot, p_k)) in self.feet.iter_mut().zip(ncp.feet.iter().zip(&p.feet)) {
            *step = aim.foot(foot, p_k, &p.v);
        }
        self.stall = aim.stall(ncp, p);
    }
}

/// Where a linearisation is taken and where it shall lead.
struct Aim<const W: usize> {
    epsilon: Lanes<W>,
    target: Lanes<W>,
}

impl<const W: usize> Aim<W> {
    /// (1/σ, σ linearised at the target over σ) for a squared slip speed.
    #[inline(always)]
    fn sigma(&self, slip_squared: Lanes<W>) -> (Lanes<W>, Lanes<W>) {
        let inverse = Lanes::splat(1.0) / (slip_squared + self.epsilon * self.epsilon).sqrt();
        (inverse, Lanes::splat(1.0) + self.epsilon * (self.target - self.epsilon) * inverse * inverse)
    }

    #[inline(always)]
    fn contact(&self, row: &ContactRow<W>, p: [Lanes<W>; 2], [gamma, slip]: [Lanes<W>; 2], compliance: Lanes<W>) -> ContactStep<W> {
        let one = Lanes::splat(1.0);
        let pair = Pair::new(p[0], gamma, self);
        // γ itself grows by κ dp_n
        let weight = one / (pair.a.max(Lanes::splat(2.0 / STIFFEST)) + compliance * pair.b);
        let (r_n, nn) = (-pair.value * weight, pair.b * weight);

        let (inverse, shift) = self.sigma(slip * slip);
        let p_n = p[0].max(Lanes::ZERO);
        let bound = row.mu * p_n;
        let unit = slip * inverse;
        // the matrix uses p_t clamped to the cone, which keeps its diagonal positive
        let clamped = p[1].min(bound).max(-bound);
        let tt = ((bound + clamped * unit) * inverse).min(Lanes::splat(STIFFEST));
        let ratio = p[0].gt(Lanes::ZERO).keep(-row.mu * unit);
        ContactStep { n: r_n, t: ratio * r_n - (bound * unit + p[1] * shift), nn, tn: ratio * nn, tt }
    }

    #[inline(always)]
    fn foot(&self, foot: &FootRow<W>, p: &[Lanes<W>; 2], v: &Triple<W>) -> FootStep<W> {
        let s = foot.slip(v);
        let (inverse, shift) = self.sigma(s[0] * s[0] + s[1] * s[1]);
        let unit = [s[0] * inverse, s[1] * inverse];
        let size = (p[0] * p[0] + p[1] * p[1]).sqrt();
        let outside = size.gt(foot.bound);
        let one = Lanes::splat(1.0);
        let shrink = outside.select(foot.bound / outside.select(size, one), one) * inverse;
        let inside = [p[0] * shrink, p[1] * shrink];
        let bound = foot.bound * inverse;
        FootStep {
            r: [-(foot.bound * unit[0] + p[0] * shift), -(foot.bound * unit[1] + p[1] * shift)],
            k: [[bound + inside[0] * unit[0], inside[0] * unit[1]], [inside[1] * unit[0], bound + inside[1] * unit[1]]],
        }
    }

    #[inline(always)]
    fn stall(&self, ncp: &Ncp<W>, p: &Impulses<W>) -> StallStep<W> {
        let finite = ncp.stall.lt(Lanes::splat(f64::INFINITY));
        let slack = finite.select(ncp.stall, Lanes::ZERO) - ncp.resistance(p);
        let pair = Pair::new(slack, p.pusher_yield, self);
        let one = Lanes::splat(1.0);
        StallStep { slack: finite.keep(pair.a), pusher: finite.select(pair.b, one), rhs: -finite.select(pair.value, p.pusher_yield) }
    }
}
