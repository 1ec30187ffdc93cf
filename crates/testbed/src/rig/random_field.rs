//! Smooth random functions of the plane: [`RandomField`].

use std::f64::consts::TAU;

use stickslip_filter::Draw;

/// Plane waves in a field.
const WAVES: u32 = 16;

/// A smooth random field of mean 0 and variance 1: plane waves of random direction, phase and
/// length.
#[derive(Clone, Debug)]
pub(super) struct RandomField {
    /// Wave vector (rad/m) and phase (rad).
    waves: Vec<[f64; 3]>,
}

impl RandomField {
    /// A field whose waves are one to three times `shortest` (m) long.
    pub(super) fn new(shortest: f64, draw: Draw) -> Self {
        let wave = |k: u32| {
            let [direction, phase] = [0, 1].map(|d| TAU * draw.uniform(k, d));
            let number = TAU / (shortest * (1.0 + 2.0 * draw.uniform(k, 2)));
            let (sin, cos) = libm::sincos(direction);
            [number * cos, number * sin, phase]
        };
        Self {
            waves: (0..WAVES).map(wave).collect(),
        }
    }

    /// The field at a point (m).
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let sum = self
            .waves
            .iter()
            .map(|[kx, ky, phase]| libm::cos(kx * x + ky * y + phase))
            .fold(0.0, |sum, c| sum + c);
        sum * (2.0 / f64::from(WAVES)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::random_stream::RandomStream;

    #[test]
    fn field_has_mean_0_and_variance_1_and_is_smooth() {
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for seed in 0..40 {
            let field = RandomField::new(0.05, RandomStream::Table.draw(seed));
            for k in 0..100 {
                let point = [0.013 * f64::from(k % 10), 0.017 * f64::from(k / 10)];
                let value = field.at(point);
                (sum, squares, count) = (sum + value, squares + value * value, count + 1.0);
                // the slope of a cosine of length 50 mm and amplitude sqrt(2 K) / K per wave
                assert!(
                    (field.at([point[0] + 1e-4, point[1]]) - value).abs() < 1e-4 * TAU / 0.05 * 5.7
                );
            }
        }
        let mean: f64 = sum / count;
        assert!(mean.abs() < 0.2, "{mean}");
        assert!((squares / count - 1.0).abs() < 0.2, "{}", squares / count);
    }
}
