//! Natural logarithm: [`ln`], fdlibm's polynomial (Sun Microsystems 1993) without its branches.

use crate::polynomial::polynomial;

/// ln 2 as a sum; the first number has so few digits that its multiples by exponents are exact.
pub(crate) const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
/// The rest of ln 2.
pub(crate) const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// ln x of a positive normal x: x = 2^k (1 + f) with 1 + f in [sqrt 1/2, sqrt 2), then ln(1 + f) =
/// 2 artanh s with s = f / (2 + f).
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    const SQRT_HALF_BITS: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    const EXPONENT: u64 = 0x7ff << 52;

    // the exponent that brings the mantissa to [sqrt 1/2, sqrt 2)
    let shift = x.to_bits().wrapping_sub(SQRT_HALF_BITS) & (EXPONENT | 1 << 63);
    let f = f64::from_bits(x.to_bits().wrapping_sub(shift)) - 1.0;
    let k = small_integer((shift >> 52).wrapping_add(2048) & 4095) - 2048.0;

    let s = f / (2.0 + f);
    let z = s * s;
    let tail = polynomial(z, LN);
    let half_square = 0.5 * f * f;
    k * LN2_HIGH - ((half_square - (s * (half_square + tail) + k * LN2_LOW)) - f)
}

/// Integer `n` in 0..2^52 as f64, without a conversion instruction that narrow SIMD lacks.
#[inline(always)]
fn small_integer(n: u64) -> f64 {
    const TWO_52: f64 = (1u64 << 52) as f64;
    f64::from_bits(n | TWO_52.to_bits()) - TWO_52
}

/// The highest power first.
const LN: [f64; 7] = [
    1.479_819_860_511_658_6e-1,
    1.531_383_769_920_937_3e-1,
    1.818_357_216_161_805e-1,
    2.222_219_843_214_978_4e-1,
    2.857_142_874_366_239e-1,
    3.999_999_999_940_942e-1,
    6.666_666_666_666_735e-1,
];

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Points of (0, 1), the ends and the borders of the reductions included.
    pub(crate) fn points() -> impl Iterator<Item = f64> {
        let cell = 1.0 / (1u64 << 53) as f64;
        let borders = [
            0.125,
            0.25,
            0.375,
            0.5,
            0.625,
            0.75,
            0.875,
            std::f64::consts::FRAC_1_SQRT_2,
        ];
        let near = borders
            .into_iter()
            .flat_map(move |b| [b - cell, b, b + cell]);
        let small = (1..=53).map(|k| libm::pow(2.0, -f64::from(k)) * 1.3);
        near.chain(small)
            .chain([cell, 1.0 - cell])
            .chain((1..100_000).map(|i| f64::from(i) / 1e5))
    }

    #[test]
    fn ln_agrees_with_libm_to_two_units_in_the_last_place() {
        for x in points() {
            let exact = libm::log(x);
            assert!(
                (ln(x) - exact).abs() <= 2.0 * f64::EPSILON * exact.abs(),
                "ln {x}: {} not {exact}",
                ln(x)
            );
        }
    }
}
