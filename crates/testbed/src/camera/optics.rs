//! From light to numbers: [`Optics`] are defocus, uneven light and the sensor's noise.

use image::GrayImage;
use stickslip_filter::Draw;

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
    /// Standard deviation in the dark.
    pub read_noise: f64,
    /// Variance per grey level of light, on top of it.
    pub shot_noise: f64,
}

impl Default for Optics {
    /// A well-focused camera in a lit room.
    fn default() -> Self {
        Self {
            blur: 0.6,
            lighting: Lighting { level: 235.0, gradient: [0.25, -0.15], vignetting: 0.12 },
            sensor: Sensor { read_noise: 1.5, shot_noise: 0.02 },
        }
    }
}

impl Optics {
    /// The frame of an image of returned light, row by row.
    pub(crate) fn develop(&self, light: Vec<f32>, size: [u32; 2], noise: Draw) -> GrayImage {
        let width = size[0] as usize;
        let blurred = blur(light, width, self.blur);
        let (mut even, mut odd) = (vec![0.0; blurred.len().div_ceil(2)], vec![0.0; blurred.len().div_ceil(2)]);
        noise.normal_columns(super::studio::FIRST_DRAW, 0, &mut even, &mut odd);
        let pixel = |(index, (light, normal)): (usize, (&f32, &f64))| {
            let at = [index % width, index / width];
            let level = f64::from(*light) * self.lighting.at(at, size);
            let std = (self.sensor.read_noise * self.sensor.read_noise + self.sensor.shot_noise * level).sqrt();
            // rounds: `as` cuts off, and saturates at 0 and 255
            (level + std * normal + 0.5) as u8
        };
        let bytes = blurred.iter().zip(even.iter().chain(&odd)).enumerate().map(pixel).collect();
        GrayImage::from_raw(size[0], size[1], bytes).expect("one byte for every pixel")
    }
}

impl Lighting {
    /// Grey level of full light at a pixel.
    fn at(&self, [column, row]: [usize; 2], size: [u32; 2]) -> f64 {
        // -1/2 to 1/2 over the image
        let x = (column as f64 + 0.5) / f64::from(size[0]) - 0.5;
        let y = (row as f64 + 0.5) / f64::from(size[1]) - 0.5;
        self.level * (1.0 + self.gradient[0] * x + self.gradient[1] * y) * (1.0 - self.vignetting * 2.0 * (x * x + y * y))
    }
}

/// Convolves an image with a normal density of standard deviation `sigma` (px), edges continued.
fn blur(image: Vec<f32>, width: usize, sigma: f64) -> Vec<f32> {
    if sigma <= 0.0 {
        return image;
    }
    let kernel = kernel(sigma);
    let rows: Vec<f32> = image.chunks(width).flat_map(|row| convolve(row, &kernel)).collect();
    blur_columns(&rows, width, &kernel)
}

/// Weights of a normal density at whole pixels, from the middle outwards; with their mirror images they sum to 1.
fn kernel(sigma: f64) -> Vec<f32> {
    let weights: Vec<f64> = (0..=(4.0 * sigma).ceil() as u32).map(|i| libm::exp(-0.5 * libm::pow(f64::from(i) / sigma, 2.0))).collect();
    let total = 2.0 * weights.iter().fold(0.0, |sum, w| sum + w) - weights[0];
    weights.iter().map(|w| (w / total) as f32).collect()
}

fn convolve(row: &[f32], kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() - 1;
    let (first, last) = (row[0], row[row.len() - 1]);
    let padded: Vec<f32> = [vec![first; reach], row.to_vec(), vec![last; reach]].concat();
    let at = |i: usize| (1..=reach).fold(kernel[0] * padded[i], |sum, k| sum + kernel[k] * (padded[i - k] + padded[i + k]));
    (reach..reach + row.len()).map(at).collect()
}

fn blur_columns(image: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let height = image.len() / width;
    let row = |y: isize| {
        let y = y.clamp(0, height as isize - 1) as usize;
        &image[y * width..(y + 1) * width]
    };
    let mut out = Vec::with_capacity(image.len());
    for y in 0..height as isize {
        let mut sums: Vec<f32> = row(y).iter().map(|v| kernel[0] * v).collect();
        for k in 1..kernel.len() as isize {
            let pairs = row(y - k).iter().zip(row(y + k));
            sums.iter_mut().zip(pairs).for_each(|(sum, (a, b))| *sum += kernel[k as usize] * (a + b));
        }
        out.extend(sums);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_filter::{Purpose, Streams};

    fn noise() -> Draw {
        Streams::new(3).of(Purpose::Measure).at(7)
    }

    /// A point of light becomes a normal density; its mean and its variance in both directions are known.
    #[test]
    fn blur_of_a_point_has_its_mean_and_variance() {
        let mut image = vec![0.0; 41 * 31];
        image[15 * 41 + 20] = 1.0;
        let out = blur(image, 41, 1.7);
        let moment = |f: &dyn Fn(f64, f64) -> f64| {
            out.iter().enumerate().fold(0.0, |sum, (i, v)| sum + f64::from(*v) * f((i % 41) as f64 - 20.0, (i / 41) as f64 - 15.0))
        };
        assert!((moment(&|_, _| 1.0) - 1.0).abs() < 1e-6);
        assert!(moment(&|x, _| x).abs() < 1e-6 && moment(&|_, y| y).abs() < 1e-6);
        assert!((moment(&|x, _| x * x) - 1.7 * 1.7).abs() < 0.01 && (moment(&|_, y| y * y) - 1.7 * 1.7).abs() < 0.01);
    }

    #[test]
    fn blur_keeps_an_even_image() {
        assert!(blur(vec![0.5; 20 * 10], 20, 2.0).iter().all(|v| (v - 0.5).abs() < 1e-6));
    }

    /// Mean and variance of the bytes of an even image against what was asked for, rounding (1/12) included.
    #[test]
    fn develop_has_the_noise_asked_for() {
        let lighting = Lighting { level: 200.0, gradient: [0.0; 2], vignetting: 0.0 };
        let optics = Optics { blur: 0.0, lighting, sensor: Sensor { read_noise: 1.5, shot_noise: 0.03 } };
        let frame = optics.develop(vec![0.5; 300 * 200], [300, 200], noise());
        let n = f64::from(300 * 200);
        let mean = frame.iter().fold(0.0, |sum, v| sum + f64::from(*v)) / n;
        let variance = frame.iter().fold(0.0, |sum, v| sum + (f64::from(*v) - mean).powi(2)) / n;
        let expected = 1.5 * 1.5 + 0.03 * 100.0 + 1.0 / 12.0;
        // five standard errors
        assert!((mean - 100.0).abs() < 5.0 * (expected / n).sqrt(), "{mean}");
        assert!((variance / expected - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{variance} {expected}");
    }

    #[test]
    fn develop_follows_the_light() {
        let lighting = Lighting { level: 100.0, gradient: [0.4, 0.2], vignetting: 0.0 };
        let optics = Optics { blur: 0.0, lighting, sensor: Sensor { read_noise: 0.0, shot_noise: 0.0 } };
        let frame = optics.develop(vec![1.0; 100 * 50], [100, 50], noise());
        assert_eq!(frame.get_pixel(0, 0).0, [70]);
        assert_eq!(frame.get_pixel(99, 49).0, [130]);
        assert_eq!(optics.develop(vec![9.0; 4], [2, 2], noise()).as_raw(), &[255; 4]);
    }
}
