//! A camera above the table: [`Camera`].

use crate::lens::Lens;
use crate::ray::Ray;
use crate::vector::{cross, dot, sub, unit};

/// A camera above the table: a lens, its position and its orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    lens: Lens,
    centre: [f64; 3],
    right: [f64; 3],
    down: [f64; 3],
    forward: [f64; 3],
}

/// Reason why a camera was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// The camera is not above its target.
    #[error(
        "the camera's height is {height} m; it must be positive. Put the camera above the table"
    )]
    NotAbove {
        /// Its height (m).
        height: f64,
    },
    /// A pixel sees past the table.
    #[error(
        "the pixel ({x}, {y}) looks at or above the horizon; every pixel must look down. Tilt the camera less"
    )]
    Horizon {
        /// Column (px).
        x: f64,
        /// Row (px).
        y: f64,
    },
    /// The distortion cannot be undone.
    #[error(
        "the lens sees the pixel ({x}, {y}) in no direction: its distortion folds the image over. Make its distortion smaller"
    )]
    Fold {
        /// Column (px).
        x: f64,
        /// Row (px).
        y: f64,
    },
}

impl Camera {
    /// A camera at `centre` (m) that is aimed at a point of the table (m), the world's y axis
    /// upwards in the image.
    ///
    /// # Errors
    /// The camera is not above the table, or a corner of its image sees no point of it.
    pub fn look_at(lens: Lens, centre: [f64; 3], target: [f64; 2]) -> Result<Self, CameraError> {
        let height = centre[2];
        if height <= 0.0 || !height.is_finite() {
            return Err(CameraError::NotAbove { height });
        }
        let forward = unit(sub([target[0], target[1], 0.0], centre));
        let right = unit(cross(forward, [0.0, 1.0, 0.0]));
        let camera = Self {
            lens,
            centre,
            right,
            down: cross(forward, right),
            forward,
        };
        let [width, rows] = lens.size.map(|n| f64::from(n) - 0.5);
        [[-0.5, -0.5], [width, -0.5], [width, rows], [-0.5, rows]]
            .into_iter()
            .try_for_each(|corner| camera.slope(corner).map(|_| ()))?;
        Ok(camera)
    }

    /// A camera that sees a box on the table (lower left and upper right corner, m) with some room
    /// around it; it stands off the box's middle towards negative y.
    ///
    /// # Errors
    /// The lens sees no table.
    pub fn over(lens: Lens, [low, high]: [[f64; 2]; 2]) -> Result<Self, CameraError> {
        const ROOM: f64 = 1.15;
        let needed = |k: usize| ROOM * (high[k] - low[k]) * lens.focal[k] / f64::from(lens.size[k]);
        let height = needed(0).max(needed(1)).max(0.3);
        let middle = [0, 1].map(|k| (low[k] + high[k]) / 2.0);
        Self::look_at(lens, [middle[0], middle[1] - 0.1 * height, height], middle)
    }

    /// Its lens.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }

    /// Its centre of projection (m).
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// Axes of its frame in the world: right, down, forward.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        [self.right, self.down, self.forward]
    }

    /// The pixel at which a point before the camera is seen (px).
    pub fn project(&self, point: [f64; 3]) -> [f64; 2] {
        let [x, y, depth] = self.axes().map(|axis| dot(sub(point, self.centre), axis));
        self.lens.pixel([x / depth, y / depth])
    }

    /// The point at height `z` (m) that a pixel sees.
    ///
    /// # Errors
    /// The pixel sees no point of the table.
    pub fn point_at(&self, pixel: [f64; 2], z: f64) -> Result<[f64; 2], CameraError> {
        Ok(Ray {
            origin: self.centre,
            slope: self.slope(pixel)?,
        }
        .at(z))
    }

    /// The point at height `z` (m) on the line of sight to a point.
    pub(crate) fn on_line_of_sight(&self, point: [f64; 3], z: f64) -> [f64; 3] {
        let share = (z - self.centre[2]) / (point[2] - self.centre[2]);
        std::array::from_fn(|i| self.centre[i] + share * (point[i] - self.centre[i]))
    }

    /// Displacement along x and y per metre of descent on the ray of a pixel.
    pub(crate) fn slope(&self, pixel: [f64; 2]) -> Result<[f64; 2], CameraError> {
        let [x, y] = pixel;
        let [a, b] = self
            .lens
            .direction(pixel)
            .ok_or(CameraError::Fold { x, y })?;
        let direction: [f64; 3] =
            std::array::from_fn(|i| a * self.right[i] + b * self.down[i] + self.forward[i]);
        if direction[2] < -1e-3 {
            Ok([direction[0] / -direction[2], direction[1] / -direction[2]])
        } else {
            Err(CameraError::Horizon { x, y })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(Lens::industrial(), [0.02, -0.08, 0.6], [0.03, 0.01]).unwrap()
    }

    /// Straight down without distortion, the image is the table scaled by focal length over height.
    #[test]
    fn project_straight_down_scales_by_focal_length_over_height() {
        let lens = Lens {
            radial: [0.0; 2],
            tangential: [0.0; 2],
            ..Lens::industrial()
        };
        let camera = Camera::look_at(lens, [0.1, 0.2, 0.5], [0.1, 0.2]).unwrap();
        let [u, v] = camera.project([0.13, 0.24, 0.1]);
        assert!(
            (u - (324.3 + 1205.0 * 0.03 / 0.4)).abs() < 1e-9
                && (v - (236.8 - 1203.0 * 0.04 / 0.4)).abs() < 1e-9,
            "{u} {v}"
        );
    }

    #[test]
    fn point_at_undoes_project_at_any_height() {
        for point in [[0.0, 0.0, 0.0], [0.1, -0.05, 0.03], [-0.08, 0.07, 0.2]] {
            let [x, y] = camera()
                .point_at(camera().project(point), point[2])
                .unwrap();
            assert!(
                (x - point[0]).abs() < 1e-12 && (y - point[1]).abs() < 1e-12,
                "{point:?}"
            );
        }
    }

    #[test]
    fn over_sees_the_whole_box() {
        for bounds in [[[-0.1, -0.05], [0.2, 0.07]], [[0.0, 0.0], [0.1, 0.5]]] {
            let camera = Camera::over(Lens::industrial(), bounds).unwrap();
            for (x, y) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let [u, v] = camera.project([bounds[x][0], bounds[y][1], 0.0]);
                assert!(
                    (0.0..640.0).contains(&u) && (0.0..480.0).contains(&v),
                    "{u} {v}"
                );
            }
        }
    }

    #[test]
    fn on_line_of_sight_is_seen_at_the_same_pixel() {
        let point = [0.05, 0.02, 0.01];
        let [a, b] = [
            camera().project(point),
            camera().project(camera().on_line_of_sight(point, 0.2)),
        ];
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
    }

    #[test]
    fn look_at_refuses_what_sees_no_table() {
        assert_eq!(
            Camera::look_at(Lens::industrial(), [0.0, 0.0, -0.1], [0.0, 0.0]),
            Err(CameraError::NotAbove { height: -0.1 })
        );
        let flat = Camera::look_at(Lens::industrial(), [0.0, 0.0, 0.1], [3.0, 0.0]).unwrap_err();
        assert!(matches!(flat, CameraError::Horizon { .. }), "{flat}");
        let folded = Lens {
            radial: [-8.0, 0.0],
            ..Lens::industrial()
        };
        assert!(
            Camera::look_at(folded, [0.0, 0.0, 0.5], [0.0, 0.0])
                .unwrap_err()
                .to_string()
                .contains("folds")
        );
    }
}
