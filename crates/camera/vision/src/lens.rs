//! The lens: [`Lens`], Brown–Conrady distortion over a pinhole.

use nalgebra::{Matrix2, SMatrix, Vector2};

/// Numbers of a lens that a calibration finds.
pub(crate) const PARAMETERS: usize = 8;

/// A pinhole with Brown–Conrady distortion, as OpenCV and ROS (`plumb_bob`) have it.
///
/// The camera's frame has x right and y down. A point with the direction (x, y, 1) is seen at (x',
/// y'):
///
/// ```text
/// r² = x² + y²
/// x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
/// y' = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y
/// ```
///
/// Its pixel is (fx x' + cx, fy y' + cy). Without distortion it would be at (fx x + cx, fy y + cy),
/// its *ideal* pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Columns and rows of the image.
    pub size: [u32; 2],
    /// Focal lengths fx, fy (px).
    pub focal: [f64; 2],
    /// Principal point cx, cy (px).
    pub centre: [f64; 2],
    /// Radial distortion k1, k2, k3; a calibration leaves k3 as it is.
    pub radial: [f64; 3],
    /// Tangential distortion p1, p2.
    pub tangential: [f64; 2],
}

impl Lens {
    /// A lens without distortion, its axis in the image's middle.
    pub fn pinhole(size: [u32; 2], focal: f64) -> Self {
        let centre = size.map(|n| (f64::from(n) - 1.0) / 2.0);
        Self {
            size,
            focal: [focal; 2],
            centre,
            radial: [0.0; 3],
            tangential: [0.0; 2],
        }
    }

    /// The ideal pixel of the direction (x, y, 1).
    pub(crate) fn ideal(&self, direction: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(
            self.focal[0] * direction.x + self.centre[0],
            self.focal[1] * direction.y + self.centre[1],
        )
    }

    /// The direction (x, y, 1) of an ideal pixel.
    pub(crate) fn direction(&self, ideal: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(
            (ideal.x - self.centre[0]) / self.focal[0],
            (ideal.y - self.centre[1]) / self.focal[1],
        )
    }

    /// The pixel where a point with an ideal pixel is seen.
    pub fn distort(&self, ideal: [f64; 2]) -> [f64; 2] {
        self.ideal(self.bend(self.direction(ideal.into())).0).into()
    }

    /// The ideal pixel of the direction that is seen at a pixel (px); `None` where the distortion
    /// has no inverse.
    pub fn undistort(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        /// Directions this near are one.
        const CLOSE: f64 = 1e-13;
        let seen = self.direction(pixel.into());
        let mut direction = seen;
        for _ in 0..50 {
            let (bent, jacobian) = self.bend(direction);
            let step = jacobian.try_inverse()? * (seen - bent);
            direction += step;
            if step.amax() < CLOSE {
                // past the fold, and on the other side of the axis, other directions are seen at
                // the same pixel
                let near =
                    self.bend(direction).1.determinant() > 0.0 && direction.dot(&seen) >= 0.0;
                return near.then(|| self.ideal(direction).into());
            }
        }
        None
    }

    /// Distance between the pixels at which this lens and another one see one direction, at most
    /// over the image (px). It is infinite for another size.
    pub fn apart(&self, other: &Self) -> f64 {
        /// Number of pixels that are compared, along each side.
        const SAMPLES: u32 = 9;
        if self.size != other.size {
            return f64::INFINITY;
        }
        let at = |side: usize, k: u32| {
            f64::from(self.size[side] - 1) * f64::from(k) / f64::from(SAMPLES - 1)
        };
        let mut most: f64 = 0.0;
        for (column, row) in (0..SAMPLES * SAMPLES).map(|k| (k % SAMPLES, k / SAMPLES)) {
            let pixel = [at(0, column), at(1, row)];
            let Some(ideal) = self.undistort(pixel) else {
                continue;
            };
            let direction = self.direction(ideal.into());
            let seen = other.ideal(other.bend(direction).0) - Vector2::from(pixel);
            most = if seen.norm() > most {
                seen.norm()
            } else {
                most
            };
        }
        most
    }

    /// Returns true if it has any distortion.
    pub fn is_distorted(&self) -> bool {
        self.radial != [0.0; 3] || self.tangential != [0.0; 2]
    }

    /// The pixel of the direction (x, y, 1), with its derivatives by direction and by the lens's
    /// eight numbers.
    pub(crate) fn project(
        &self,
        direction: Vector2<f64>,
    ) -> (Vector2<f64>, Matrix2<f64>, SMatrix<f64, 2, PARAMETERS>) {
        let (bent, by_direction) = self.bend(direction);
        let (x, y, [fx, fy]) = (direction.x, direction.y, self.focal);
        let r2 = x * x + y * y;
        #[rustfmt::skip]
        let by_lens = SMatrix::<f64, 2, PARAMETERS>::from_row_slice(&[
            bent.x, 0.0, 1.0, 0.0, fx * x * r2, fx * x * r2 * r2, fx * 2.0 * x * y, fx * (r2 + 2.0 * x * x),
            0.0, bent.y, 0.0, 1.0, fy * y * r2, fy * y * r2 * r2, fy * (r2 + 2.0 * y * y), fy * 2.0 * x * y,
        ]);
        (
            self.ideal(bent),
            Matrix2::from_diagonal(&self.focal.into()) * by_direction,
            by_lens,
        )
    }

    /// The numbers that a calibration finds: fx, fy, cx, cy (px), k1, k2, p1, p2.
    pub fn calibrated(&self) -> [f64; PARAMETERS] {
        let ([fx, fy], [cx, cy]) = (self.focal, self.centre);
        let ([k1, k2, _], [p1, p2]) = (self.radial, self.tangential);
        [fx, fy, cx, cy, k1, k2, p1, p2]
    }

    /// Adds to its eight numbers (fx, fy, cx, cy, k1, k2, p1, p2).
    pub(crate) fn moved(&self, by: &[f64]) -> Self {
        let add = |pair: [f64; 2], at: usize| [pair[0] + by[at], pair[1] + by[at + 1]];
        let [k1, k2, k3] = self.radial;
        let [k1, k2] = add([k1, k2], 4);
        Self {
            size: self.size,
            focal: add(self.focal, 0),
            centre: add(self.centre, 2),
            radial: [k1, k2, k3],
            tangential: add(self.tangential, 6),
        }
    }

    /// (x', y') of (x, y), with derivatives.
    fn bend(&self, direction: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let ([k1, k2, k3], [p1, p2]) = (self.radial, self.tangential);
        let (x, y) = (direction.x, direction.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * (3.0 * k3))); // by r², twice: times x or y it is the derivative by x or y
        let bent = Vector2::new(
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let mixed = x * y * slope + 2.0 * (p1 * x + p2 * y);
        let by_direction = Matrix2::new(
            radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            mixed,
            mixed,
            radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        (bent, by_direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens() -> Lens {
        Lens {
            size: [640, 480],
            focal: [610.0, 605.0],
            centre: [330.0, 236.0],
            radial: [-0.3, 0.1, -0.05],
            tangential: [2e-3, -1e-3],
        }
    }

    #[test]
    fn undistort_undoes_distort() {
        for ideal in [[0.0, 0.0], [639.0, 479.0], [100.0, 400.0], [330.0, 236.0]] {
            let [x, y] = lens().undistort(lens().distort(ideal)).unwrap();
            assert!(
                (x - ideal[0]).abs() < 1e-9 && (y - ideal[1]).abs() < 1e-9,
                "{ideal:?}"
            );
        }
    }

    /// OpenCV's formula, written out for one point: x = 0.5, y = -0.25, r² = 0.3125.
    #[test]
    fn distort_is_the_formula_of_opencv() {
        let lens = Lens {
            size: [100, 100],
            focal: [100.0, 200.0],
            centre: [50.0, 40.0],
            radial: [0.5, -0.25, 2.0],
            tangential: [0.125, -0.0625],
        };
        let [r2, r4, r6] = [0.3125, 0.097_656_25, 0.030_517_578_125];
        let radial = 1.0 + 0.5 * r2 - 0.25 * r4 + 2.0 * r6;
        let x = 0.5 * radial + 2.0 * 0.125 * (0.5 * -0.25) - 0.0625 * (r2 + 2.0 * 0.25);
        let y = -0.25 * radial + 0.125 * (r2 + 2.0 * 0.0625) + 2.0 * -0.0625 * (0.5 * -0.25);
        let seen = lens.distort([100.0, -10.0]);
        assert!((seen[0] - (100.0 * x + 50.0)).abs() < 1e-12, "{seen:?}");
        assert!((seen[1] - (200.0 * y + 40.0)).abs() < 1e-12, "{seen:?}");
    }

    #[test]
    fn apart_is_how_far_one_lens_is_moved() {
        let lens = lens();
        let moved = Lens {
            centre: [lens.centre[0] + 3.0, lens.centre[1] - 4.0],
            ..lens
        };
        assert!((lens.apart(&moved) - 5.0).abs() < 1e-9);
        assert!(lens.apart(&lens) < 1e-9);
        let other = Lens {
            size: [320, 240],
            ..lens
        };
        assert_eq!(lens.apart(&other), f64::INFINITY);
    }

    #[test]
    fn undistort_past_a_fold_is_none() {
        let folded = Lens {
            radial: [-2.0, 0.0, 0.0],
            ..lens()
        };
        assert_eq!(folded.undistort([639.0, 479.0]), None);
    }

    /// Derivatives against central differences.
    #[test]
    fn project_has_the_derivatives_of_its_value() {
        const H: f64 = 1e-6;
        let (at, lens) = (Vector2::new(0.31, -0.24), lens());
        let (_, by_direction, by_lens) = lens.project(at);
        for k in 0..2 {
            let step = Vector2::from_fn(|i, _| if i == k { H } else { 0.0 });
            let numeric = (lens.project(at + step).0 - lens.project(at - step).0) / (2.0 * H);
            assert!(
                (numeric - by_direction.column(k)).amax() < 1e-6,
                "direction {k}"
            );
        }
        for k in 0..PARAMETERS {
            let step = |h: f64| {
                std::array::from_fn::<f64, PARAMETERS, _>(|i| if i == k { h } else { 0.0 })
            };
            let numeric = (lens.moved(&step(H)).project(at).0
                - lens.moved(&step(-H)).project(at).0)
                / (2.0 * H);
            assert!((numeric - by_lens.column(k)).amax() < 1e-5, "parameter {k}");
        }
    }
}
