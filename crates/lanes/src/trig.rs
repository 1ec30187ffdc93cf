//! Sine and cosine of many angles at once: [`sin_cos`], the polynomials of fdlibm (Sun Microsystems
//! 1993) without its branches.

use crate::lanes::Lanes;
use crate::mask::Mask;

/// π/2 as a sum of three numbers, the first two with so few digits that their multiples by whole
/// numbers below 2²⁰ are exact (Cody & Waite 1980).
const QUARTER: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_95e-21,
];

/// sin x = x + x³ p(x²): coefficients of p, the highest power first.
pub(crate) const SIN: [f64; 6] = [
    1.589_690_995_211_55e-10,
    -2.505_076_025_340_686_3e-8,
    2.755_731_370_707_006_8e-6,
    -1.984_126_982_985_795e-4,
    8.333_333_333_322_49e-3,
    -1.666_666_666_666_663_2e-1,
];

/// cos x = 1 − x²/2 + x⁴ p(x²): coefficients of p, the highest power first.
pub(crate) const COS: [f64; 6] = [
    -1.135_964_755_778_819_5e-11,
    2.087_572_321_298_175e-9,
    -2.755_731_435_139_066_3e-7,
    2.480_158_728_947_673e-5,
    -1.388_888_888_887_411e-3,
    4.166_666_666_666_66e-2,
];

/// (sin x, cos x) to a few units in the last place, for |x| up to 10⁶ rad.
///
/// Products are fused; [`box_muller`](crate::box_muller) has a sine and cosine without.
#[inline(always)]
pub fn sin_cos<const W: usize>(x: Lanes<W>) -> (Lanes<W>, Lanes<W>) {
    let turns = (x * std::f64::consts::FRAC_2_PI).round();
    let reduced = x - turns * QUARTER[0] - turns * QUARTER[1] - turns * QUARTER[2];
    let (sin, cos) = sin_cos_eighth(reduced);

    // number of quarter turns, −2..=2: odd ones swap sine and cosine, and it gives both signs
    let quarter = turns - (turns * 0.25).round() * 4.0;
    let odd = equal(quarter.abs(), 1.0);
    let half = equal(quarter.abs(), 2.0);
    let (s, c) = (odd.select(cos, sin), odd.select(sin, cos));
    let negative_sin = half | equal(quarter, -1.0);
    let negative_cos = half | equal(quarter, 1.0);
    (negative_sin.select(-s, s), negative_cos.select(-c, c))
}

#[inline(always)]
fn equal<const W: usize>(x: Lanes<W>, value: f64) -> Mask<W> {
    !(x - value).abs().gt(Lanes::ZERO)
}

/// [`sin_cos`] on [−π/4, π/4].
#[inline(always)]
fn sin_cos_eighth<const W: usize>(x: Lanes<W>) -> (Lanes<W>, Lanes<W>) {
    let z = x * x;
    let sin = x + x * z * polynomial(z, SIN);
    let half = z * 0.5;
    let one_less = Lanes::splat(1.0) - half;
    let cos = one_less + (((Lanes::splat(1.0) - one_less) - half) + z * z * polynomial(z, COS));
    (sin, cos)
}

/// c_0 z⁵ + … + c_5.
#[inline(always)]
fn polynomial<const W: usize>(z: Lanes<W>, coefficients: [f64; 6]) -> Lanes<W> {
    let mut sum = Lanes::splat(coefficients[0]);
    for c in &coefficients[1..] {
        sum = Lanes::splat(*c).add_mul(sum, z);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sin_cos_agrees_with_libm_over_many_turns() {
        let borders = (-64..=64).flat_map(|k| {
            [-1e-9, 0.0, 1e-9].map(|d| f64::from(k) * std::f64::consts::FRAC_PI_4 + d)
        });
        let spread = (0..200_000).map(|i| (f64::from(i) - 1e5) * 0.012_345_678_9);
        for x in borders.chain(spread).chain([1e5, -1e5, 999_999.3]) {
            let (s, c) = sin_cos(Lanes([x]));
            let (sin, cos) = libm::sincos(x);
            assert!(
                (s.0[0] - sin).abs() < 4e-16 && (c.0[0] - cos).abs() < 4e-16,
                "{x}: {} {}, not {sin} {cos}",
                s.0[0],
                c.0[0]
            );
        }
    }
}
