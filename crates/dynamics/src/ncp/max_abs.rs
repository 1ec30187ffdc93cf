//! The largest absolute value of some numbers, lane by lane: [`MaxAbs`].

use stickslip_lanes::Lanes;

/// The largest absolute value of the numbers accumulated so far; NaN counts as larger than all.
#[derive(Clone, Copy, Debug)]
pub struct MaxAbs<const W: usize>(Lanes<W>);

impl<const W: usize> MaxAbs<W> {
    /// Of no number.
    pub const ZERO: Self = Self(Lanes::ZERO);

    /// Takes one more number into account.
    #[inline(always)]
    pub fn accumulate(&mut self, number: Lanes<W>) {
        let Self(largest) = self;
        // without its sign, a double orders as its bits do, NaN after infinity
        for (largest, number) in largest.0.iter_mut().zip(number.0) {
            let size = number.abs().to_bits() as i64;
            *largest = f64::from_bits(size.max(largest.to_bits() as i64) as u64);
        }
    }

    /// The largest absolute value; infinity in place of NaN.
    #[inline(always)]
    pub fn value(self) -> Lanes<W> {
        let infinity = Lanes::splat(f64::INFINITY);
        self.0.lt(infinity).select(self.0, infinity)
    }

    /// The largest absolute value of numbers whose squares were accumulated; may be NaN.
    #[inline(always)]
    pub fn sqrt(self) -> Lanes<W> {
        self.0.sqrt()
    }
}
