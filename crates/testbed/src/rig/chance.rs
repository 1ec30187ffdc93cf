//! Random numbers of the rig: one stream for each thing that is random ([`Topic`]), and smooth
//! random fields ([`Waves`]).

use std::f64::consts::TAU;

use stickslip_filter::{Draw, Streams};

/// Cosines in a field.
const WAVES: u32 = 16;

/// What is random about a rig.
#[derive(Clone, Copy, Debug)]
pub(super) enum Topic {
    /// Where the points of the support lie.
    Points,
    /// Load of each point.
    Roughness,
    /// How the load varies over the face.
    Pressure,
    /// How friction varies over the table.
    Table,
    /// Phases of the drive's ripple.
    Drive,
}

impl Topic {
    /// The numbers of this topic under a seed.
    pub(super) fn draw(self, seed: u64) -> Draw {
        Streams::new(seed).at(self as u64)
    }
}

/// A smooth random field of mean 0 and variance 1 over the plane: plane waves of random direction,
/// phase and length.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    /// Wave vector (rad/m) and phase (rad).
    waves: Vec<[f64; 3]>,
}

impl Waves {
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

    #[test]
    fn waves_have_mean_0_and_variance_1_and_are_smooth() {
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for seed in 0..40 {
            let waves = Waves::new(0.05, Topic::Table.draw(seed));
            for k in 0..100 {
                let point = [0.013 * f64::from(k % 10), 0.017 * f64::from(k / 10)];
                let value = waves.at(point);
                (sum, squares, count) = (sum + value, squares + value * value, count + 1.0);
                // the slope of a cosine of length 50 mm and amplitude sqrt(2 K) / K per wave
                assert!(
                    (waves.at([point[0] + 1e-4, point[1]]) - value).abs() < 1e-4 * TAU / 0.05 * 5.7
                );
            }
        }
        let mean: f64 = sum / count;
        assert!(mean.abs() < 0.2, "{mean}");
        assert!((squares / count - 1.0).abs() < 0.2, "{}", squares / count);
    }
}
