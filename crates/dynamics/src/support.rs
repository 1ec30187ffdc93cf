//! The support of one particle: [`Support`].

use stickslip_lanes::{Lanes, sin_cos};

/// Stretch below which sinh x / x is not computed as such: any small number will do.
const LEAST_STRETCH: f64 = 1e-9;

/// Affine image of the scene's feet, in the object's frame: r + c + A (p − r) of a foot at p, where
/// r is their centre of friction. Three equal feet become any triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support<T = f64> {
    /// c, the displacement of the centre of friction (m).
    pub centre: [T; 2],
    /// A, row by row.
    pub map: [[T; 2]; 2],
}

impl<T> Support<T> {
    /// Applies `f` to every number.
    #[inline(always)]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Support<U> {
        Support {
            centre: self.centre.map(&f),
            map: self.map.map(|row| row.map(&f)),
        }
    }
}

impl Default for Support {
    /// The scene's feet themselves.
    fn default() -> Self {
        Self {
            centre: [0.0; 2],
            map: [[1.0, 0.0], [0.0, 1.0]],
        }
    }
}

impl<const W: usize> Support<Lanes<W>> {
    /// Feet that are turned about their centre of friction by an angle (rad), then stretched about
    /// it by the exponential of the symmetric matrix ((a, b), (b, −a)), where `stretch` is a and b;
    /// `centre` is the displacement (m). The area of the triangle stays.
    #[inline(always)]
    pub fn new(centre: [Lanes<W>; 2], turn: Lanes<W>, stretch: [Lanes<W>; 2]) -> Self {
        let [a, b] = stretch;
        let size = (a * a).add_mul(b, b).sqrt();
        let factor = size.exp();
        let inverse = Lanes::splat(1.0) / factor;
        let cosh = (factor + inverse) * 0.5;
        let ratio = (factor - inverse) * 0.5 / size.max(Lanes::splat(LEAST_STRETCH));
        let (sin, cos) = sin_cos(turn);
        let [[xx, xy], [yx, yy]] = [[cosh + ratio * a, ratio * b], [ratio * b, cosh - ratio * a]];
        Self {
            centre,
            map: [
                [xx * cos + xy * sin, xy * cos - xx * sin],
                [yx * cos + yy * sin, yy * cos - yx * sin],
            ],
        }
    }

    /// The feet as many times as far from their centre of friction.
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, factor: Lanes<W>) -> Self {
        Self {
            map: self.map.map(|row| row.map(|x| x * factor)),
            ..self
        }
    }
}
