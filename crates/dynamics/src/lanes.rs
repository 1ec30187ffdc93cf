//! `W` particles side by side: [`Lanes`] and [`Mask`].
//!
//! Element i of every `Lanes` of a block belongs to particle i. All operations are lane-wise and
//! exactly rounded, on any machine; where a product and a sum are rounded together, [`Lanes::plus`]
//! and [`Lanes::less`] say so. A particle's result does not depend on `W` nor on its neighbours;
//! `Lanes<1>` is the scalar reference.

use std::array::from_fn;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

/// `W` numbers, one per particle; no vector of them crosses a line of the cache.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const W: usize>(pub [f64; W]);

/// `W` conditions, one per particle; as wide as the numbers that they choose between, so that
/// choosing is bitwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub struct Mask<const W: usize>([u64; W]);

/// A condition that holds.
const YES: u64 = u64::MAX;

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

    /// 1/√x of positive normal numbers, to 3e-12; finite where x is 0, not finite where it is not.
    /// Nothing waits for the divider.
    ///
    /// Halving the exponent gives 1/√x to 3.4 % (Lomont 2003). A Newton step leaves 3/2 of the
    /// error's square, always on one side: half of that is added to the first.
    #[inline(always)]
    pub fn inverse_sqrt(self) -> Self {
        const FIRST_GUESS: u64 = 0x5fe6_eb50_c7b5_37a9;
        const LONGER: f64 = 1.0 + 8.8e-4;
        let newton =
            |y: Self, half: Self, longer: f64| y * Self::splat(1.5 * longer).less(half * y, y);
        let y = Self(from_fn(|i| {
            f64::from_bits(FIRST_GUESS.wrapping_sub(self.0[i].to_bits() >> 1))
        }));
        let y = newton(y, self * (0.5 * LONGER), LONGER);
        let half = self * 0.5;
        newton(newton(y, half, 1.0), half, 1.0)
    }

    /// The nearest whole number, of sizes below 2⁵⁰; halves go to the even one.
    #[inline(always)]
    pub fn round(self) -> Self {
        // from here on doubles are whole numbers
        const WHOLE: f64 = 6_755_399_441_055_744.0;
        (self + WHOLE) - WHOLE
    }

    /// self + a b, rounded once.
    #[inline(always)]
    #[expect(
        clippy::disallowed_methods,
        reason = "correctly rounded on any machine"
    )]
    pub fn plus(self, a: Self, b: Self) -> Self {
        Self(from_fn(|i| a.0[i].mul_add(b.0[i], self.0[i])))
    }

    /// self − a b, rounded once.
    #[inline(always)]
    #[expect(
        clippy::disallowed_methods,
        reason = "correctly rounded on any machine"
    )]
    pub fn less(self, a: Self, b: Self) -> Self {
        Self(from_fn(|i| (-a.0[i]).mul_add(b.0[i], self.0[i])))
    }

    /// Where `self > other`.
    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<W> {
        Mask(from_fn(|i| if self.0[i] > other.0[i] { YES } else { 0 }))
    }

    /// Where `self < other`.
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

/// Copies lane `lane` of several numbers into lane `slot` of as many others.
#[inline(always)]
pub fn copy_lane<const N: usize, const V: usize, const W: usize>(
    to: [&mut Lanes<V>; N],
    slot: usize,
    from: [&Lanes<W>; N],
    lane: usize,
) {
    for k in 0..N {
        to[k].0[slot] = from[k].0[lane];
    }
}

impl<const W: usize> Mask<W> {
    /// The same condition in every lane.
    #[inline(always)]
    pub const fn splat(value: bool) -> Self {
        Self([if value { YES } else { 0 }; W])
    }

    /// The condition of each lane.
    #[inline(always)]
    pub fn from_fn(lane: impl Fn(usize) -> bool) -> Self {
        Self(from_fn(|i| if lane(i) { YES } else { 0 }))
    }

    /// Whether the condition holds in one lane.
    #[inline(always)]
    pub fn lane(self, i: usize) -> bool {
        self.0[i] != 0
    }

    /// Sets one lane.
    #[inline(always)]
    pub fn set(&mut self, i: usize, value: bool) {
        self.0[i] = if value { YES } else { 0 };
    }

    /// `yes` where the condition holds, `no` elsewhere.
    #[inline(always)]
    pub fn select(self, yes: Lanes<W>, no: Lanes<W>) -> Lanes<W> {
        Lanes(from_fn(|i| {
            f64::from_bits(self.0[i] & yes.0[i].to_bits() | !self.0[i] & no.0[i].to_bits())
        }))
    }

    /// `yes` where the condition holds, 0 elsewhere.
    #[inline(always)]
    pub fn keep(self, yes: Lanes<W>) -> Lanes<W> {
        Lanes(from_fn(|i| f64::from_bits(self.0[i] & yes.0[i].to_bits())))
    }

    /// Whether the condition holds in every lane.
    #[inline(always)]
    pub fn all(self) -> bool {
        self.0.iter().fold(YES, |all, lane| all & lane) != 0
    }

    /// Whether the condition holds in some lane.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.iter().fold(0, |any, lane| any | lane) != 0
    }

    /// The lanes where the condition holds, in order.
    #[inline(always)]
    pub fn lanes(self) -> impl Iterator<Item = usize> {
        let mut left = self.bits();
        std::iter::from_fn(move || {
            let lane = (left != 0).then(|| left.trailing_zeros() as usize);
            left &= left.wrapping_sub(1);
            lane
        })
    }

    /// In how many lanes the condition holds.
    #[inline(always)]
    pub fn count(self) -> u32 {
        self.bits().count_ones()
    }

    /// One bit per lane.
    #[inline(always)]
    fn bits(self) -> u64 {
        const { assert!(W <= 64, "a bit for every lane") };
        (0..W).fold(0, |bits, i| bits | (self.0[i] & 1) << i)
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

impl<const W: usize> BitAnd for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl<const W: usize> BitOr for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] | other.0[i]))
    }
}

impl<const W: usize> Not for Mask<W> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(from_fn(|i| !self.0[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instructions::on_widest;
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
            [(-one).plus(x, x), -one.less(x, x)]
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

    #[test]
    fn lanes_of_a_mask_come_in_order() {
        let mask = Mask::<8>::from_fn(|lane| [1, 2, 7].contains(&lane));
        assert_eq!(
            (mask.lanes().collect::<Vec<_>>(), mask.count()),
            (vec![1, 2, 7], 3)
        );
        assert_eq!(
            (
                Mask::<64>::splat(true).lanes().count(),
                Mask::<64>::splat(false).count()
            ),
            (64, 0)
        );
    }
}
