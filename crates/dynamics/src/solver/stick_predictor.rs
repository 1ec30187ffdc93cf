//! The impulse that would make a foot stick, [`StickPredictor`], and a foot's linear model in a
//! given mode.

use stickslip_lanes::{Lanes, Mask};

use crate::ncp::rows::square;
use crate::solver::linearised::FootStep;

/// Weight k of slip against impulse near a solution.
pub const SLIP_WEIGHT_NEAR: f64 = 2.0e8;

/// Keeps quotients finite.
const TINY: f64 = 1e-300;

/// The trial impulse z = p − k s of a foot, k the weight of slip against impulse. The foot sticks
/// where z is within the friction bound; else it slides, with its impulse along z.
#[derive(Clone, Copy, Debug)]
pub struct StickPredictor<const W: usize> {
    z: [Lanes<W>; 2],
    /// |z|².
    square: Lanes<W>,
    /// k.
    slip_weight: f64,
}

impl<const W: usize> StickPredictor<W> {
    /// Of a foot with impulse p and slip velocity s.
    #[inline(always)]
    pub fn new(p: &[Lanes<W>; 2], slip: &[Lanes<W>; 2], slip_weight: f64) -> Self {
        let k = Lanes::splat(slip_weight);
        let z = [p[0].sub_mul(k, slip[0]), p[1].sub_mul(k, slip[1])];
        Self {
            z,
            square: square(&z),
            slip_weight,
        }
    }

    /// Lanes in which it is outside the friction disc.
    #[inline(always)]
    pub fn exceeds(&self, bound: Lanes<W>) -> Mask<W> {
        self.square.gt(bound * bound)
    }
}

impl<const W: usize> FootStep<W> {
    /// A foot that slides where `slides`, with p = bound z / |z|; elsewhere its slip is driven to
    /// zero with penalty `stiffness`.
    ///
    /// The sliding law is linearised with p itself, shrunk into its disc, in place of bound z / |z|
    /// (Andersen et al. 2000). Far from the solution, where p and s do not oppose each other yet,
    /// that keeps the impulse from turning too far in one step.
    #[inline(always)]
    pub fn in_mode(
        bound: Lanes<W>,
        p: &[Lanes<W>; 2],
        slip: &[Lanes<W>; 2],
        predictor: &StickPredictor<W>,
        slides: Mask<W>,
        stiffness: Lanes<W>,
    ) -> Self {
        let stick = [-slip[0] * stiffness, -slip[1] * stiffness];
        // a root and a division only where some foot slides
        if !slides.any() {
            return Self {
                r: stick,
                k: [[stiffness, Lanes::ZERO], [Lanes::ZERO, stiffness]],
            };
        }
        let StickPredictor {
            z,
            square: z_squared,
            slip_weight,
        } = *predictor;
        let inverse_length = z_squared.inverse_sqrt();
        // k |s|, where it slides
        let speed = (-bound).add_mul(z_squared, inverse_length).max(bound);
        let bound_squared = bound * bound;
        let size = square(p).max(bound_squared);
        // one division gives both k / speed and the factor that shrinks p into the disc
        let inverse = Lanes::splat(1.0) / (speed * size).max(Lanes::splat(TINY));
        // in this order a foot without a bound has 0 here, however fast it slips
        let inside = inverse * bound_squared * slip_weight;
        let full = inverse * size * slip_weight * bound;
        let u = [z[0] * inverse_length, z[1] * inverse_length];
        let q = [p[0] * inside, p[1] * inside];
        Self {
            r: [
                slides.select((-p[0]).add_mul(bound, u[0]), stick[0]),
                slides.select((-p[1]).add_mul(bound, u[1]), stick[1]),
            ],
            k: [
                [
                    slides.select(full.sub_mul(q[0], u[0]), stiffness),
                    slides.zero_unless(-q[0] * u[1]),
                ],
                [
                    slides.zero_unless(-q[1] * u[0]),
                    slides.select(full.sub_mul(q[1], u[1]), stiffness),
                ],
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foot_without_friction_lets_go_of_its_impulse_however_fast_it_slips() {
        let vector = |x: f64| [Lanes([x]), Lanes([-0.5 * x])];
        for slip in [1e-12, 1e-3, 1.0, 1e6] {
            for p in [0.0, 1e-6, 3.0] {
                let predictor = StickPredictor::new(&vector(p), &vector(slip), SLIP_WEIGHT_NEAR);
                let step = FootStep::in_mode(
                    Lanes::ZERO,
                    &vector(p),
                    &vector(slip),
                    &predictor,
                    predictor.exceeds(Lanes::ZERO),
                    Lanes([5e8]),
                );
                assert_eq!(step.r, vector(p).map(|p| -p), "slip {slip}, impulse {p}");
                assert_eq!(step.k, [[Lanes::ZERO; 2]; 2], "slip {slip}, impulse {p}");
            }
        }
    }
}
