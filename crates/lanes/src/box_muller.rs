//! Two uniform numbers to two normal ones (Box & Muller 1958), written so that a loop over
//! particles vectorises.
//!
//! radius = sqrt(-2 ln u), angle = 2 pi v: the pair (radius cos, radius sin). Logarithm, sine and
//! cosine are the polynomials of fdlibm (Sun Microsystems 1993) without its branches and tables:
//! plain arithmetic, no fused multiply-add, hence the same bits in scalar code, on SSE2, AVX2,
//! AVX-512 and NEON. Errors are a few units in the last place.

use crate::lanes::ROUND;
use crate::ln::ln;
use crate::polynomial::polynomial;
use crate::trig::{COS, SIN};

/// Two normal numbers from `u` and `v` in (0, 1), multiples of 2^-53.
#[inline(always)]
pub fn box_muller(u: f64, v: f64) -> [f64; 2] {
    let radius = (-2.0 * ln(u)).sqrt();
    let (sin, cos) = sin_cos_turns(v);
    [radius * cos, radius * sin]
}

/// sin and cos of 2 pi v, v in [0, 1]: v minus its nearest quarter turn is exact, the rest is in
/// [-pi/4, pi/4].
///
/// It is not [`sin_cos`](crate::sin_cos) of 2 pi v: an angle in turns is reduced exactly, and the
/// random numbers are compiled for the baseline too, where a fused product is a slow call. The bits
/// differ, and recorded runs depend on both.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ln::tests::points;

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
