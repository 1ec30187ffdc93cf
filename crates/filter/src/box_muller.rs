//! Two uniform numbers to two normal ones (Box & Muller 1958), written so that a loop over
//! particles vectorises.
//!
//! radius = sqrt(-2 ln u), angle = 2 pi v: the pair (radius cos, radius sin). Logarithm, sine and
//! cosine are the polynomials of fdlibm (Sun Microsystems 1993) without its branches and tables:
//! plain arithmetic, no fused multiply-add, hence the same bits in scalar code, on SSE2, AVX2,
//! AVX-512 and NEON. Errors are a few units in the last place.

/// ln 2 as a sum; the first number has so few digits that its multiples by exponents are exact.
pub(crate) const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
/// The rest of ln 2.
pub(crate) const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// 1.5 2^52: adding it rounds to the nearest integer, and leaves that in the low bits.
pub(crate) const ROUND: f64 = 6_755_399_441_055_744.0;

/// Two normal numbers from `u` and `v` in (0, 1), multiples of 2^-53.
#[inline(always)]
pub(crate) fn box_muller(u: f64, v: f64) -> [f64; 2] {
    let radius = (-2.0 * ln(u)).sqrt();
    let (sin, cos) = sin_cos_turns(v);
    [radius * cos, radius * sin]
}

/// Integer `n` in 0..2^52 as f64, without a conversion instruction that narrow SIMD lacks.
#[inline(always)]
fn small_integer(n: u64) -> f64 {
    const TWO_52: f64 = (1u64 << 52) as f64;
    f64::from_bits(n | TWO_52.to_bits()) - TWO_52
}

/// ln x of a positive normal x: x = 2^k (1 + f) with 1 + f in [sqrt 1/2, sqrt 2), then ln(1 + f) =
/// 2 artanh s with s = f / (2 + f).
#[inline(always)]
fn ln(x: f64) -> f64 {
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

/// sin and cos of 2 pi v, v in [0, 1]: v less its nearest quarter turn is exact, the rest is in
/// [-pi/4, pi/4].
#[inline(always)]
fn sin_cos_turns(v: f64) -> (f64, f64) {
    let rounded = 4.0 * v + ROUND;
    let quarter = rounded.to_bits();
    let x = std::f64::consts::TAU * (v - 0.25 * (rounded - ROUND));
    let (sin, cos) = sin_cos_eighth(x);

    let (s, c) = if quarter & 1 == 0 {
        (sin, cos)
    } else {
        (cos, sin)
    };
    (flip(s, quarter), flip(c, quarter.wrapping_add(1)))
}

/// x with its sign changed where `quarter` is 2 or 3 of 4.
#[inline(always)]
fn flip(x: f64, quarter: u64) -> f64 {
    f64::from_bits(x.to_bits() ^ ((quarter & 2) << 62))
}

/// sin and cos on [-pi/4, pi/4].
#[inline(always)]
fn sin_cos_eighth(x: f64) -> (f64, f64) {
    let z = x * x;
    let sin = x + x * polynomial(z, SIN);
    let one_less = 1.0 - 0.5 * z;
    let cos = one_less + (((1.0 - one_less) - 0.5 * z) + z * polynomial(z, COS));
    (sin, cos)
}

/// z (c_0 + z (c_1 + ...)).
#[inline(always)]
pub(crate) fn polynomial<const N: usize>(z: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for c in coefficients.into_iter().rev() {
        sum = z * (c + sum);
    }
    sum
}

const LN: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of (0, 1), the ends and the borders of the reductions included.
    fn points() -> impl Iterator<Item = f64> {
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

    #[test]
    fn sin_cos_turns_agrees_with_libm() {
        for v in points() {
            let (sin, cos) = sin_cos_turns(v);
            // libm's own argument 2 pi v is rounded: up to half a unit in the last place of 2 pi
            let (s, c) = libm::sincos(std::f64::consts::TAU * v);
            assert!(
                (sin - s).abs() < 1e-15 && (cos - c).abs() < 1e-15,
                "{v}: {sin} {cos}, not {s} {c}"
            );
        }
    }
}
