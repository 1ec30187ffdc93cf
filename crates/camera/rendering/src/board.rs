//! A board of tags for calibration: [`Board`], and poses to hold it in: [`calibration_poses`].

use crate::camera::{Camera, CameraError};
use crate::ray::Ray;
use crate::render_scene::VisiblePart;
use crate::sampler::View;
use crate::tag::{Tag, TagCells};
use crate::vector::{cross, dot, rotate, sub};

/// A flat board of tags in rows and columns.
///
/// Its frame has the origin in the lower left corner of the black square of tag 0, x to the right,
/// y up as printed, z towards the viewer. Tags are counted along x, then along y.
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// Tags in a row.
    pub columns: usize,
    /// Edge of a black square (m).
    pub tag_size: f64,
    /// White between neighbouring black squares (m).
    pub gap: f64,
    /// Cells of the tags, row by row from below.
    pub tags: Vec<TagCells>,
}

/// Pose of a board in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardPose {
    /// The board's origin (m).
    pub origin: [f64; 3],
    /// The board's x and y axes, of length 1.
    pub axes: [[f64; 3]; 2],
}

/// A board held over the plate.
pub(crate) struct BoardView<'a> {
    pub(crate) board: &'a Board,
    pub(crate) pose: &'a BoardPose,
    pub(crate) around: VisiblePart<'a>,
}

impl Board {
    /// Tags above each other.
    pub fn rows(&self) -> usize {
        self.tags.len() / self.columns
    }

    /// From the first black square's lower left corner to the last one's upper right (m).
    pub fn extent(&self) -> [f64; 2] {
        [self.columns, self.rows()].map(|n| n as f64 * (self.tag_size + self.gap) - self.gap)
    }

    /// Grey at a point of its plane; `None` off the board.
    fn grey(&self, [x, y]: [f64; 2]) -> Option<f32> {
        let pitch = self.tag_size + self.gap;
        let [width, height] = self.extent();
        let margin = self.gap.max(self.tag_size / 8.0);
        if !(-margin..width + margin).contains(&x) || !(-margin..height + margin).contains(&y) {
            return None;
        }
        let cell = |along: f64, count: usize| ((along / pitch).max(0.0) as usize).min(count - 1);
        let (column, row) = (cell(x, self.columns), cell(y, self.rows()));
        let middle = |index: usize| index as f64 * pitch + self.tag_size / 2.0;
        let tag = Tag {
            cells: self.tags[row * self.columns + column],
            size: self.tag_size,
        };
        Some(tag.grey([x - middle(column), y - middle(row)]))
    }
}

impl BoardPose {
    /// Flat on the table with its print at height `z` (m), its origin at `position` (m).
    pub fn flat(position: [f64; 2], z: f64) -> Self {
        Self {
            origin: [position[0], position[1], z],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }

    /// A point of the board's plane in the world (m).
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|i| self.origin[i] + x * self.axes[0][i] + y * self.axes[1][i])
    }

    /// Intersection of a ray with the board's plane, in its frame, and its height above the table.
    fn intersect(&self, ray: &Ray) -> ([f64; 2], f64) {
        let normal = cross(self.axes[0], self.axes[1]);
        let direction = [ray.slope[0], ray.slope[1], -1.0];
        let descent = dot(sub(self.origin, ray.origin), normal) / dot(direction, normal);
        let from_origin: [f64; 3] =
            std::array::from_fn(|i| ray.origin[i] + descent * direction[i] - self.origin[i]);
        (
            self.axes.map(|axis| dot(from_origin, axis)),
            ray.origin[2] - descent,
        )
    }
}

impl View for BoardView<'_> {
    fn grey(&self, ray: &Ray, instant: usize) -> f32 {
        let (point, height) = self.pose.intersect(ray);
        let table = self.around.hit(ray, instant);
        self.board
            .grey(point)
            .filter(|_| height >= table.height)
            .unwrap_or(table.grey)
    }

    fn is_static(&self) -> bool {
        true
    }
}

/// `count` poses for a calibration.
///
/// In the first one the board lies flat on the table, its print at height `thickness` (m) and its
/// middle where the image's is. In the others it is held above the table, tilted by 20° to 35° to
/// all sides and moved over the image.
///
/// # Errors
/// A pixel of the camera sees no table.
pub fn calibration_poses(
    camera: &Camera,
    board: &Board,
    thickness: f64,
    count: usize,
) -> Result<Vec<BoardPose>, CameraError> {
    let size = camera.lens().size.map(f64::from);
    let half = board.extent().map(|side| side / 2.0);
    let middle = camera.point_at(size.map(|n| (n - 1.0) / 2.0), 0.0)?;
    let flat = BoardPose::flat([middle[0] - half[0], middle[1] - half[1]], thickness);
    let held = (1..count).map(|k| {
        // nine places over the image in turn, with another turn and tilt each time
        let place = [k % 3, (k / 3) % 3].map(|third| 0.3 + 0.2 * third as f64);
        let height = 0.06 + 0.02 * (k % 4) as f64;
        let at = camera.point_at([place[0] * size[0], place[1] * size[1]], height)?;
        let axes = tilted_axes(k as f64);
        let origin = std::array::from_fn(|i| {
            [at[0], at[1], height][i] - half[0] * axes[0][i] - half[1] * axes[1][i]
        });
        Ok(BoardPose { origin, axes })
    });
    [Ok(flat)].into_iter().chain(held).collect()
}

/// Axes of a board rotated by up to 0.3 rad about its normal, then tilted about an axis that
/// rotates by the golden angle from pose to pose.
fn tilted_axes(k: f64) -> [[f64; 3]; 2] {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let tilt = 0.35 + 0.13 * (1.0 + libm::sin(1.7 * k));
    let axis = [
        libm::cos(GOLDEN_ANGLE * k),
        libm::sin(GOLDEN_ANGLE * k),
        0.0,
    ];
    let (sin, cos) = libm::sincos(0.3 * libm::sin(2.3 * k));
    [[cos, sin, 0.0], [-sin, cos, 0.0]].map(|v| rotate(v, axis, tilt))
}
