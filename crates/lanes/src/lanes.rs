//! One number of `W` particles side by side: [`Lanes`].
//!
//! Element i of every `Lanes` of a block belongs to particle i. Every operation acts on each lane
//! alone and is correctly rounded on any machine; only [`Lanes::add_mul`] and [`Lanes::sub_mul`]
//! round a product and a sum once. So a particle's result depends neither on `W` nor on its
//! neighbours, and `Lanes<1>` is the scalar reference.

use crate::exp::exp;
use crate::ln::ln;
use std::array::from_fn;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::mask::{Mask, YES};

/// 1.5 2⁵²: adding it rounds to the nearest whole number and leaves that in the low bits.
pub(crate) const ROUND: f64 = 6_755_399_441_055_744.0;

/// `W` numbers, one per particle, aligned so that no vector of them straddles two cache lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const W: usize>(pub [f64; W]);

impl<const W: usize> Lanes<W> {
    /// 0 in every lane.
    pub const ZERO: Self = Self([0.0; W]);

    /// `value` in every lane.
    #[inline(always)]
    pub const fn splat(value: f64) -> Self {
        Self([value; W])
    }

    /// The larger of two, lane by lane.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.gt(other).select(self, other)
    }

    /// The smaller of two, lane by lane.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        other.gt(self).select(self, other)
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(from_fn(|i| self.0[i].abs()))
    }

    /// Square root, correctly rounded.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(from_fn(|i| self.0[i].sqrt()))
    }

    /// ln x of positive normal numbers.
    #[inline(always)]
    pub fn ln(self) -> Self {
        // from_fn with a long closure is compiled out of line, by baseline code
        let mut of = self;
        for x in &mut of.0 {
            *x = ln(*x);
        }
        of
    }

    /// e^x of numbers up to 700.
    #[inline(always)]
    pub fn exp(self) -> Self {
        // from_fn with a long closure is compiled out of line, by baseline code
        let mut of = self;
        for x in &mut of.0 {
            *x = exp(*x);
        }
        of
    }

    /// 1/√x of positive normal numbers, with a relative error below 3e-12 and without the slow
    /// divider. It is finite where x is 0, and not finite where x is not.
    ///
    /// Halving the exponent gives a guess within 3.4 % (Lomont 2003). A Newton step leaves a
    /// relative error of 3/2 of the old one's square, and always a value that is too small; so the
    /// first step's result is made longer by half of its largest error.
    #[inline(always)]
    pub fn inverse_sqrt(self) -> Self {
        const FIRST_GUESS: u64 = 0x5fe6_eb50_c7b5_37a9;
        const LONGER: f64 = 1.0 + 8.8e-4;
        let newton =
            |y: Self, half: Self, longer: f64| y * Self::splat(1.5 * longer).sub_mul(half * y, y);
        let y = Self(from_fn(|i| {
            f64::from_bits(FIRST_GUESS.wrapping_sub(self.0[i].to_bits() >> 1))
        }));
        let y = newton(y, self * (0.5 * LONGER), LONGER);
        let half = self * 0.5;
        newton(newton(y, half, 1.0), half, 1.0)
    }

    /// The nearest integer, for |x| below 2⁵⁰; ties go to the even one.
    #[inline(always)]
    pub fn round(self) -> Self {
        (self + ROUND) - ROUND
    }

    /// self + a b, rounded once (a fused multiply-add).
    #[inline(always)]
    #[expect(
        clippy::disallowed_methods,
        reason = "correctly rounded on any machine"
    )]
    pub fn add_mul(self, a: Self, b: Self) -> Self {
        Self(from_fn(|i| a.0[i].mul_add(b.0[i], self.0[i])))
    }

    /// self − a b, rounded once.
    #[inline(always)]
    #[expect(
        clippy::disallowed_methods,
        reason = "correctly rounded on any machine"
    )]
    pub fn sub_mul(self, a: Self, b: Self) -> Self {
        Self(from_fn(|i| (-a.0[i]).mul_add(b.0[i], self.0[i])))
    }

    /// Lanes in which `self > other`.
    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<W> {
        Mask(from_fn(|i| if self.0[i] > other.0[i] { YES } else { 0 }))
    }

    /// Lanes in which `self < other`.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<W> {
        other.gt(self)
    }

    /// +1 where the number is positive, −1 elsewhere.
    #[inline(always)]
    pub fn sign(self) -> Self {
        self.gt(Self::ZERO)
            .select(Self::splat(1.0), Self::splat(-1.0))
    }
}

impl<const W: usize> Default for Lanes<W> {
    fn default() -> Self {
        Self::ZERO
    }
}

macro_rules! lane_wise {
    ($($operator:ident $method:ident $sign:tt),*) => {$(
        impl<const W: usize> $operator for Lanes<W> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $sign other.0[i]))
            }
        }
        impl<const W: usize> $operator<f64> for Lanes<W> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self(from_fn(|i| self.0[i] $sign other))
            }
        }
    )*};
}
lane_wise!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const W: usize> Neg for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(from_fn(|i| -self.0[i]))
    }
}

impl<const W: usize> AddAssign for Lanes<W> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const W: usize> SubAssign for Lanes<W> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::on_widest;
    use fearless_simd::Level;

    #[test]
    fn inverse_sqrt_agrees_with_root_and_division() {
        let mantissas = (0..4096).map(|i| 1.0 + f64::from(i) / 1024.0);
        for x in
            mantissas.flat_map(|m| [-1000, -301, -7, 0, 1, 300, 1000].map(|e| m * 2f64.powi(e)))
        {
            let (found, exact) = (Lanes([x]).inverse_sqrt().0[0], 1.0 / x.sqrt());
            assert!(
                (found / exact - 1.0).abs() < 3e-12,
                "{x:e}: {found:e}, not {exact:e}"
            );
        }
        assert!(Lanes([0.0]).inverse_sqrt().0[0].is_finite());
        let [not, infinite] = Lanes([f64::NAN, f64::INFINITY]).inverse_sqrt().0;
        assert!(not.is_nan() && !infinite.is_finite());
    }

    /// (1 + 2⁻³⁰)² − 1 has the digits 2⁻²⁹ + 2⁻⁶⁰; a product that was rounded first would have lost
    /// the last one.
    #[test]
    fn products_and_sums_are_rounded_once_on_any_instructions() {
        let (x, exact) = (1.0 + 2f64.powi(-30), 2f64.powi(-29) + 2f64.powi(-60));
        let squares = |x: f64| {
            let (one, x) = (
                Lanes::<8>::splat(1.0),
                Lanes::<8>::splat(std::hint::black_box(x)),
            );
            [(-one).add_mul(x, x), -one.sub_mul(x, x)]
        };
        for level in [Level::baseline(), Level::new()] {
            let found = on_widest(
                level,
                #[inline(always)]
                || squares(x),
            );
            assert_eq!(found, [Lanes::splat(exact); 2]);
        }
    }
}
