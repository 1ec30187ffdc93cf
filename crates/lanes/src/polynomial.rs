//! Polynomials in plain arithmetic: [`polynomial`].

/// c_0 z^N + ... + c_(N-1) z, without fused multiply-add.
#[inline(always)]
pub(crate) fn polynomial<const N: usize>(z: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for c in coefficients {
        sum = z * (c + sum);
    }
    sum
}
