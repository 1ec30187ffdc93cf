//! The border of a tag's black square in an image: [`Outline`], the pixels along it, and
//! [`Square`], the shape fitted to them.

use image::GrayImage;
use nalgebra::{Matrix2, SMatrix, Vector2};

use crate::edge::{Edge, LEAST_BAND, Sample, WIDEST_BAND};
use crate::lens::Lens;

/// Pixels this much farther from the rough border are kept too, since the fitted border lies
/// elsewhere (px).
const SLACK: f64 = 2.0;

/// The pixels along a tag's border.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// Rough corners (px), anti-clockwise from the lower left as printed.
    pub(crate) corners: [[f64; 2]; 4],
    /// Pixels near the edge from each corner to the next, as seen.
    edges: [Vec<Sample>; 4],
}

/// The corners of a tag's black square, as ideal pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    /// Anti-clockwise from the lower left as printed (px).
    pub(crate) corners: [Vector2<f64>; 4],
    /// Covariance of x0, y0, x1, ... (px²).
    pub(crate) covariance: SMatrix<f64, 8, 8>,
}

impl Outline {
    /// The pixels of `image` along the edges between rough corners.
    pub(crate) fn gather(image: &GrayImage, corners: [[f64; 2]; 4]) -> Self {
        let edges =
            std::array::from_fn(|k| near(image, corners[k].into(), corners[(k + 1) % 4].into()));
        Self { corners, edges }
    }

    /// Fits the four edges, straight for an ideal lens, and intersects them; `None` where one
    /// cannot be fitted.
    pub(crate) fn fit(&self, lens: &Lens) -> Option<Square> {
        let mut corners = [Vector2::zeros(); 4];
        for (ideal, seen) in corners.iter_mut().zip(self.corners) {
            *ideal = lens.undistort(seen)?.into();
        }
        let mut edges = [Edge::default(); 4];
        for (k, edge) in edges.iter_mut().enumerate() {
            let ideal = |sample: &Sample| {
                Some(Sample {
                    at: lens.undistort(sample.at.into())?.into(),
                    level: sample.level,
                })
            };
            let samples: Vec<Sample> = self.edges[k].iter().map(ideal).collect::<Option<_>>()?;
            let [from, to] = [corners[k], corners[(k + 1) % 4]];
            *edge = Edge::fit(&samples, [from, to], cell(from, to))?;
        }
        Square::between(&edges)
    }
}

impl Square {
    /// The square between four edges, each from one corner to the next; `None` where neighbours are
    /// parallel.
    fn between(edges: &[Edge; 4]) -> Option<Self> {
        let mut corners = [Vector2::zeros(); 4];
        // corners by the four edges' (offset, turn)
        let mut jacobian = SMatrix::<f64, 8, 8>::zeros();
        let mut of_edges = SMatrix::<f64, 8, 8>::zeros();
        for (k, edge) in edges.iter().enumerate() {
            of_edges
                .fixed_view_mut::<2, 2>(2 * k, 2 * k)
                .copy_from(&edge.covariance);
            let before = (k + 3) % 4;
            let rows = [edges[before].row(), edge.row()];
            let inverse =
                Matrix2::from_rows(&rows.map(|(normal, _)| normal.transpose())).try_inverse()?;
            corners[k] = inverse * Vector2::new(rows[0].1, rows[1].1);
            for (column, index) in [before, k].into_iter().enumerate() {
                let moved = inverse.column(column) * edges[index].shift_at(corners[k]);
                jacobian
                    .fixed_view_mut::<2, 2>(2 * k, 2 * index)
                    .copy_from(&moved);
            }
        }
        Some(Self {
            corners,
            covariance: jacobian * of_edges * jacobian.transpose(),
        })
    }
}

/// Edge of a tag's cells (px): the border inside an edge from corner to corner and the margin
/// outside are a cell wide.
fn cell(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    (to - from).norm() / 8.0
}

/// The pixels within the band and some more about the edge from corner to corner.
fn near(image: &GrayImage, from: Vector2<f64>, to: Vector2<f64>) -> Vec<Sample> {
    let half_width = (WIDEST_BAND * cell(from, to)).max(LEAST_BAND) + SLACK;
    let length = (to - from).norm();
    let along = (to - from) / length;
    let range = |axis: usize, end: u32| {
        let [low, high] = [
            from[axis].min(to[axis]) - half_width,
            from[axis].max(to[axis]) + half_width,
        ];
        low.ceil().max(0.0) as u32..(high.floor() + 1.0).clamp(0.0, f64::from(end)) as u32
    };
    let mut samples = Vec::new();
    for row in range(1, image.height()) {
        for column in range(0, image.width()) {
            let at = Vector2::new(f64::from(column), f64::from(row));
            if (at - from).perp(&along).abs() <= half_width
                && (0.0..=length).contains(&(at - from).dot(&along))
            {
                samples.push(Sample {
                    at,
                    level: f64::from(image.get_pixel(column, row).0[0]),
                });
            }
        }
    }
    samples
}
