//! From light to numbers: [`Optics`] are defocus, uneven light and the sensor's noise.

use image::GrayImage;
use stickslip_filter::Draw;

use crate::draws::FIRST_DRAW;
use crate::sampler::SUBPIXELS;

/// Everything between the light that the scene returns and the frame's bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// Standard deviation of the blur of lens and defocus (px).
    pub blur: f64,
    /// The light.
    pub lighting: Lighting,
    /// The sensor.
    pub sensor: Sensor,
}

/// Light that falls unevenly on the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// Grey level of a surface that returns all light, in the image's middle.
    pub level: f64,
    /// Relative change of the light over the image's width and height.
    pub gradient: [f64; 2],
    /// Relative loss in the image's corners.
    pub vignetting: f64,
}

/// Noise of the sensor, in grey levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Standard deviation without light.
    pub read_noise: f64,
    /// Variance per grey level of light, on top of it.
    pub shot_noise: f64,
}

impl Default for Optics {
    /// A well-focused camera in a lit room.
    fn default() -> Self {
        Self {
            blur: 0.6,
            lighting: Lighting {
                level: 235.0,
                gradient: [0.25, -0.15],
                vignetting: 0.12,
            },
            sensor: Sensor {
                read_noise: 1.5,
                shot_noise: 0.02,
            },
        }
    }
}

impl Optics {
    /// The frame of an image of light, subpixels row by row.
    pub(crate) fn capture(&self, light: &[f32], size: [u32; 2], noise: Draw) -> GrayImage {
        let width = size[0] as usize;
        let blurred = blur(light, size.map(|n| n as usize), self.blur);
        let (mut even, mut odd) = (
            vec![0.0; blurred.len().div_ceil(2)],
            vec![0.0; blurred.len().div_ceil(2)],
        );
        noise.normal_columns(FIRST_DRAW, 0, &mut even, &mut odd);
        let pixel = |(index, (light, normal)): (usize, (&f32, &f64))| {
            let at = [index % width, index / width];
            let level = f64::from(*light) * self.lighting.at(at, size);
            let std = (self.sensor.read_noise * self.sensor.read_noise
                + self.sensor.shot_noise * level)
                .sqrt();
            // rounds: `as` cuts off, and saturates at 0 and 255
            (level + std * normal + 0.5) as u8
        };
        let bytes = blurred
            .iter()
            .zip(even.iter().chain(&odd))
            .enumerate()
            .map(pixel)
            .collect();
        GrayImage::from_raw(size[0], size[1], bytes).expect("one byte for every pixel")
    }
}

impl Lighting {
    /// Grey level of full light at a pixel.
    fn at(&self, [column, row]: [usize; 2], size: [u32; 2]) -> f64 {
        // -1/2 to 1/2 over the image
        let x = (column as f64 + 0.5) / f64::from(size[0]) - 0.5;
        let y = (row as f64 + 0.5) / f64::from(size[1]) - 0.5;
        self.level
            * (1.0 + self.gradient[0] * x + self.gradient[1] * y)
            * (1.0 - self.vignetting * 2.0 * (x * x + y * y))
    }
}

/// The pixels of an image of subpixels, blurred by a normal density of standard deviation `sigma`
/// (px) and averaged over each pixel's area; beyond its edges the image goes on unchanged.
fn blur(light: &[f32], [columns, rows]: [usize; 2], sigma: f64) -> Vec<f32> {
    let kernel = kernel(sigma);
    let margin = (kernel.len() - SUBPIXELS) / 2;
    let width = columns * SUBPIXELS;
    let mut image = Vec::with_capacity(columns * rows);
    let mut sums = vec![0.0; width + 2 * margin];
    for row in 0..rows {
        // down the columns
        sums.fill(0.0);
        for (k, weight) in kernel.iter().enumerate() {
            let y = (row * SUBPIXELS + k)
                .saturating_sub(margin)
                .min(rows * SUBPIXELS - 1);
            let below = &light[y * width..(y + 1) * width];
            sums[margin..]
                .iter_mut()
                .zip(below)
                .for_each(|(sum, light)| *sum += weight * light);
        }

        // along the row
        let [first, last] = [sums[margin], sums[margin + width - 1]];
        sums[..margin].fill(first);
        sums[margin + width..].fill(last);
        let pixel = |column: usize| {
            let seen = &sums[column * SUBPIXELS..][..kernel.len()];
            seen.iter()
                .zip(&kernel)
                .fold(0.0, |sum, (light, weight)| sum + weight * light)
        };
        image.extend((0..columns).map(pixel));
    }
    image
}

/// Weights of a row's subpixels in one of its pixels: a normal density integrated over the pixel's
/// width.
fn kernel(sigma: f64) -> Vec<f32> {
    use std::f64::consts::SQRT_2;
    let margin = (4.0 * sigma * SUBPIXELS as f64).ceil() as usize;
    // distance of a subpixel's middle from the pixel's first edge (px)
    let at = |k: usize| (k as f64 - margin as f64 + 0.5) / SUBPIXELS as f64;
    let below = |z: f64| libm::erf(z / (SQRT_2 * sigma));
    let weights: Vec<f64> = (0..SUBPIXELS + 2 * margin)
        .map(|k| below(at(k)) - below(at(k) - 1.0))
        .collect();
    let total: f64 = weights.iter().sum();
    weights
        .iter()
        .map(|weight| (weight / total) as f32)
        .collect()
}

#[cfg(test)]
mod tests {
    use stickslip_filter::{Purpose, Streams};

    use super::*;

    fn noise() -> Draw {
        Streams::new(3).of(Purpose::Measure).at(7)
    }

    /// The subpixels of an even image.
    fn even(light: f32, [columns, rows]: [usize; 2]) -> Vec<f32> {
        vec![light; columns * rows * SUBPIXELS * SUBPIXELS]
    }

    /// A point of light becomes a normal density; its sum, mean and variance in both directions are
    /// known.
    #[test]
    fn blur_of_a_point_has_its_mean_and_variance() {
        let [column, row] = [40, 31];
        let mut light = even(0.0, [41, 31]);
        light[row * 41 * SUBPIXELS + column] = (SUBPIXELS * SUBPIXELS) as f32;
        let out = blur(&light, [41, 31], 1.7);
        let [x0, y0] = [column, row].map(|fine| (fine as f64 + 0.5) / SUBPIXELS as f64 - 0.5);
        let moment = |f: &dyn Fn(f64, f64) -> f64| {
            out.iter().enumerate().fold(0.0, |sum, (i, v)| {
                sum + f64::from(*v) * f((i % 41) as f64 - x0, (i / 41) as f64 - y0)
            })
        };
        assert!(
            (moment(&|_, _| 1.0) - 1.0).abs() < 1e-4,
            "{}",
            moment(&|_, _| 1.0)
        );
        assert!(moment(&|x, _| x).abs() < 1e-3 && moment(&|_, y| y).abs() < 1e-3);
        // the pixel's own area adds 1/12
        let variance = 1.7 * 1.7 + 1.0 / 12.0;
        assert!(
            (moment(&|x, _| x * x) - variance).abs() < 0.01
                && (moment(&|_, y| y * y) - variance).abs() < 0.01
        );
    }

    /// An edge along a row is seen as the normal distribution function's mean over every pixel, in
    /// closed form, wherever in the row it lies. Blurred by whole pixels it would be off by up to
    /// 0.05, subpixels leave a quarter.
    #[test]
    fn blur_of_an_edge_along_a_row_is_that_of_any_edge() {
        const SIGMA: f64 = 0.6;
        let integral = |x: f64| {
            let z = x / SIGMA;
            let below = 0.5 * (1.0 + libm::erf(z / 2.0_f64.sqrt()));
            x * below + SIGMA * libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt()
        };
        for tenths in 0..10 {
            let edge = 10.0 + f64::from(tenths) / 10.0;
            let share = |subpixel: usize| {
                (subpixel as f64 + 1.0 - edge * SUBPIXELS as f64).clamp(0.0, 1.0) as f32
            };
            let light: Vec<f32> = (0..20 * SUBPIXELS)
                .flat_map(|row| [share(row); 2 * SUBPIXELS])
                .collect();
            for (row, seen) in blur(&light, [2, 20], SIGMA).chunks(2).enumerate() {
                let from = row as f64 - edge;
                let exact = integral(from + 1.0) - integral(from);
                assert!(
                    (f64::from(seen[0]) - exact).abs() < 0.0125 && seen[0] == seen[1],
                    "{edge} {row}: {seen:?}, exact {exact}"
                );
            }
        }
    }

    #[test]
    fn blur_keeps_an_even_image() {
        assert!(
            blur(&even(0.5, [20, 10]), [20, 10], 2.0)
                .iter()
                .all(|v| (v - 0.5).abs() < 1e-6)
        );
        assert!(
            blur(&even(0.5, [20, 10]), [20, 10], 0.0)
                .iter()
                .all(|v| *v == 0.5)
        );
    }

    /// Mean and variance of the bytes of an even image, compared with the requested ones, rounding
    /// (1/12) included.
    #[test]
    fn capture_has_the_noise_asked_for() {
        let lighting = Lighting {
            level: 200.0,
            gradient: [0.0; 2],
            vignetting: 0.0,
        };
        let optics = Optics {
            blur: 0.0,
            lighting,
            sensor: Sensor {
                read_noise: 1.5,
                shot_noise: 0.03,
            },
        };
        let frame = optics.capture(&even(0.5, [300, 200]), [300, 200], noise());
        let n = f64::from(300 * 200);
        let mean = frame.iter().fold(0.0, |sum, v| sum + f64::from(*v)) / n;
        let variance = frame
            .iter()
            .fold(0.0, |sum, v| sum + (f64::from(*v) - mean).powi(2))
            / n;
        let expected = 1.5 * 1.5 + 0.03 * 100.0 + 1.0 / 12.0;
        // five standard errors
        assert!((mean - 100.0).abs() < 5.0 * (expected / n).sqrt(), "{mean}");
        assert!(
            (variance / expected - 1.0).abs() < 5.0 * (2.0 / n).sqrt(),
            "{variance} {expected}"
        );
    }

    #[test]
    fn capture_follows_the_light() {
        let lighting = Lighting {
            level: 100.0,
            gradient: [0.4, 0.2],
            vignetting: 0.0,
        };
        let optics = Optics {
            blur: 0.0,
            lighting,
            sensor: Sensor {
                read_noise: 0.0,
                shot_noise: 0.0,
            },
        };
        let frame = optics.capture(&even(1.0, [100, 50]), [100, 50], noise());
        assert_eq!(frame.get_pixel(0, 0).0, [70]);
        assert_eq!(frame.get_pixel(99, 49).0, [130]);
        assert_eq!(
            optics.capture(&even(9.0, [2, 2]), [2, 2], noise()).as_raw(),
            &[255; 4]
        );
    }
}
