//! A condition per lane: [`Mask`].

use std::array::from_fn;
use std::ops::{BitAnd, BitOr, Not};

use crate::lanes::Lanes;

/// `W` conditions, one per particle; each is as wide as the numbers that it selects, so that
/// selecting is bitwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub struct Mask<const W: usize>(pub(crate) [u64; W]);

/// The bits of a condition that holds.
pub(crate) const YES: u64 = u64::MAX;

impl<const W: usize> Mask<W> {
    /// One condition for every lane.
    #[inline(always)]
    pub const fn splat(value: bool) -> Self {
        Self([if value { YES } else { 0 }; W])
    }

    /// Each lane's condition as a function of its number.
    #[inline(always)]
    pub fn from_fn(lane: impl Fn(usize) -> bool) -> Self {
        Self(from_fn(|i| if lane(i) { YES } else { 0 }))
    }

    /// Returns true if the condition is met in one lane.
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
    pub fn zero_unless(self, yes: Lanes<W>) -> Lanes<W> {
        Lanes(from_fn(|i| f64::from_bits(self.0[i] & yes.0[i].to_bits())))
    }

    /// Returns true if the condition is met in every lane.
    #[inline(always)]
    pub fn all(self) -> bool {
        self.0.iter().fold(YES, |all, lane| all & lane) != 0
    }

    /// Returns true if the condition is met in some lane.
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

    /// Number of lanes in which the condition is met.
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
