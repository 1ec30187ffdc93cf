//! e^x of many numbers at once: [`exponentials`].

use fearless_simd::Level;

use crate::dispatch::on_widest;
use crate::lanes::ROUND;
use crate::ln::{LN2_HIGH, LN2_LOW};
use crate::polynomial::polynomial;

/// Turns every x of `exponents` into e^(x − largest); none of them may exceed `largest` or be NaN.
pub fn exponentials(exponents: &mut [f64], largest: f64) {
    on_widest(
        Level::new(),
        #[inline(always)]
        || {
            for x in exponents {
                *x = exp(*x - largest);
            }
        },
    );
}

/// e^x of an x of at most 700: fdlibm's (Sun Microsystems 1993) bit for bit, without its branches.
///
/// x = k ln 2 + r with |r| <= ln 2 / 2, and e^r = 1 + 2 r / (R(r²) - r), R a polynomial.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    /// e^x is 0 from here down.
    const LEAST: f64 = -746.0;

    let x = if x > LEAST { x } else { LEAST };
    let k = whole(x * std::f64::consts::LOG2_E);
    let (high, low) = (x - k * LN2_HIGH, k * LN2_LOW);
    let r = high - low;
    let c = r - polynomial(r * r, EXP);
    let mantissa = 1.0 + (r * c / (2.0 - c) - low + high);
    // in two steps, the second of which rounds where the result is subnormal
    let half = whole(0.5 * k);
    mantissa * power_of_two(half) * power_of_two(k - half)
}

#[inline(always)]
fn whole(x: f64) -> f64 {
    (x + ROUND) - ROUND
}

/// 2^k of a whole k in -1022..=1023.
#[inline(always)]
fn power_of_two(k: f64) -> f64 {
    f64::from_bits((k + (ROUND + 1023.0)).to_bits() << 52)
}

/// The highest power first.
const EXP: [f64; 5] = [
    4.138_136_797_057_238_5e-8,
    -1.653_390_220_546_525_2e-6,
    6.613_756_321_437_934e-5,
    -2.777_777_777_701_559_3e-3,
    1.666_666_666_666_660_2e-1,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_agrees_with_libm_to_the_bit_down_to_zero() {
        let steps = (0..1_000_000).map(|i| -746.5 * f64::from(i) / 1e6);
        let small = (0..400).map(|i| -libm::exp2(-f64::from(i)));
        for x in steps.chain(small).chain([-1e300, f64::NEG_INFINITY]) {
            assert_eq!(
                exp(x).to_bits(),
                libm::exp(x).to_bits(),
                "e^{x}: {:e}, not {:e}",
                exp(x),
                libm::exp(x)
            );
        }
    }

    #[test]
    fn exponentials_are_relative_to_the_largest() {
        let mut numbers = [1000.0, 999.0, f64::NEG_INFINITY];
        exponentials(&mut numbers, 1000.0);
        assert_eq!(numbers, [1.0, libm::exp(-1.0), 0.0]);
    }
}
