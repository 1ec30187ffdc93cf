//! Lens and sensor raster: [`Lens`], a pinhole with Brown–Conrady distortion.

/// A pinhole with radial and tangential distortion (Brown 1966) and a raster of pixels.
///
/// The camera's frame has x right and y down. A point with the direction (x, y, 1) is seen at (x',
/// y'):
///
/// ```text
/// r² = x² + y²
/// x' = x (1 + k1 r² + k2 r⁴) + 2 p1 x y + p2 (r² + 2 x²)
/// y' = y (1 + k1 r² + k2 r⁴) + p1 (r² + 2 y²) + 2 p2 x y
/// ```
///
/// Its pixel is (fx x' + cx, fy y' + cy). The centre of the first pixel is (0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Columns and rows of the raster.
    pub size: [u32; 2],
    /// Focal lengths fx, fy (px).
    pub focal: [f64; 2],
    /// Principal point cx, cy (px).
    pub centre: [f64; 2],
    /// Radial distortion k1, k2.
    pub radial: [f64; 2],
    /// Tangential distortion p1, p2.
    pub tangential: [f64; 2],
}

impl Lens {
    /// A lens as on an industrial camera of 640 × 480 pixels: a field of view 30° wide, 9 pixels of
    /// distortion in the corners.
    pub fn industrial() -> Self {
        Self {
            size: [640, 480],
            focal: [1205.0, 1203.0],
            centre: [324.3, 236.8],
            radial: [-0.21, 0.12],
            tangential: [8e-4, -6e-4],
        }
    }

    /// Pixel at which the direction (x, y, 1) is seen.
    pub fn pixel(&self, direction: [f64; 2]) -> [f64; 2] {
        let seen = self.distort(direction);
        [
            self.focal[0] * seen[0] + self.centre[0],
            self.focal[1] * seen[1] + self.centre[1],
        ]
    }

    /// The direction (x, y, 1) that a pixel sees; `None` where the distortion has no inverse there.
    pub fn direction(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        let seen = [
            (pixel[0] - self.centre[0]) / self.focal[0],
            (pixel[1] - self.centre[1]) / self.focal[1],
        ];
        let mut direction = seen;
        // a fixed point: the distortion is a small part of the whole
        for _ in 0..200 {
            let image = self.distort(direction);
            let error = [seen[0] - image[0], seen[1] - image[1]];
            direction = [direction[0] + error[0], direction[1] + error[1]];
            if error[0].abs().max(error[1].abs()) < 1e-14 {
                return Some(direction);
            }
        }
        None
    }

    fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([k1, k2], [p1, p2]) = (self.radial, self.tangential);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * k2);
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out by hand for (0.3, -0.2).
    #[test]
    fn pixel_follows_the_formula() {
        let lens = Lens {
            focal: [100.0, 200.0],
            centre: [10.0, 20.0],
            radial: [-0.2, 0.1],
            tangential: [0.01, 0.02],
            ..Lens::industrial()
        };
        // r2 = 0.13, radial = 1 - 0.026 + 0.00169 = 0.97569
        let x = 0.3 * 0.97569 + 2.0 * 0.01 * -0.06 + 0.02 * (0.13 + 0.18);
        let y = -0.2 * 0.97569 + 0.01 * (0.13 + 0.08) + 2.0 * 0.02 * -0.06;
        let [u, v] = lens.pixel([0.3, -0.2]);
        assert!((u - (100.0 * x + 10.0)).abs() < 1e-12 && (v - (200.0 * y + 20.0)).abs() < 1e-12);
    }

    #[test]
    fn direction_is_seen_at_its_pixel() {
        let lens = Lens::industrial();
        for pixel in [[-0.5, -0.5], [639.5, 479.5], [0.0, 479.5], [320.0, 100.0]] {
            let [u, v] = lens.pixel(lens.direction(pixel).unwrap());
            assert!(
                (u - pixel[0]).abs() < 1e-9 && (v - pixel[1]).abs() < 1e-9,
                "{pixel:?}"
            );
        }
    }

    #[test]
    fn direction_of_a_fold_is_none() {
        let folded = Lens {
            radial: [-8.0, 0.0],
            ..Lens::industrial()
        };
        assert_eq!(folded.direction([0.0, 0.0]), None);
    }
}
