//! Anti-aliasing: many rays a pixel, where it takes many, [`Sampler`].

use std::ops::Range;

use stickslip_filter::Draw;

use crate::camera::Camera;
use crate::draws::FIRST_DRAW;
use crate::ray::Ray;

/// Subpixels along a side of a pixel. The lens's blur is applied to them: applied to whole pixels,
/// it would blur an edge along a row by an amount that depends on where in the row the edge lies.
pub(crate) const SUBPIXELS: usize = 2;

/// Rays of a subpixel that sees more than one surface.
const RAYS: usize = 16;

/// Instants of the exposure; the rays of a pixel are cast at one each.
pub(crate) const INSTANTS: usize = RAYS * SUBPIXELS * SUBPIXELS;

/// Instants at which a subpixel's corners are compared, where something moves.
const PROBES: [usize; 3] = [0, INSTANTS / 2, INSTANTS - 1];

/// Subpixels along a side of a tile: few prisms are seen in one.
const TILE_SIDE: usize = 16 * SUBPIXELS;

/// Something to look at.
pub(crate) trait View {
    /// Grey of the surface that a ray meets at an instant, below [`INSTANTS`], of the exposure.
    fn grey(&self, ray: &Ray, instant: usize) -> f32;

    /// Returns true if it is equal at every instant.
    fn is_static(&self) -> bool;
}

/// A rectangle of subpixels, half-open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    pub(crate) columns: Range<usize>,
    pub(crate) rows: Range<usize>,
}

/// The rays of a camera's subpixels.
#[derive(Clone, Debug)]
pub(crate) struct Sampler {
    /// Subpixels in a row.
    columns: usize,
    /// Rows of subpixels.
    rows: usize,
    origin: [f64; 3],
    /// Slopes of the rays through the subpixels' corners, a row of `columns + 1` for every line
    /// between rows.
    corners: Vec<[f64; 2]>,
    /// Points of a subpixel at which the rays are cast, before a random shift.
    offsets: Vec<[f64; 2]>,
}

impl Sampler {
    pub(crate) fn new(camera: &Camera) -> Self {
        let [columns, rows] = camera.lens().size.map(|n| n as usize * SUBPIXELS);
        let corner = |index: usize| {
            [index % (columns + 1), index / (columns + 1)]
                .map(|line| line as f64 / SUBPIXELS as f64 - 0.5)
        };
        let slope = |index: usize| {
            camera
                .slope(corner(index))
                .expect("a camera whose corners look down does everywhere")
        };
        let corners = (0..(columns + 1) * (rows + 1)).map(slope).collect();
        Self {
            columns,
            rows,
            origin: camera.centre(),
            corners,
            offsets: offsets(),
        }
    }

    /// All subpixels, tile by tile.
    pub(crate) fn tiles(&self) -> impl Iterator<Item = Tile> {
        let ranges = |end: usize| {
            (0..end)
                .step_by(TILE_SIDE)
                .map(move |start| start..(start + TILE_SIDE).min(end))
        };
        ranges(self.rows).flat_map(move |rows| {
            ranges(self.columns).map(move |columns| Tile {
                columns,
                rows: rows.clone(),
            })
        })
    }

    /// A box that contains all that a tile sees between two heights: its lower left and upper right
    /// corner (m).
    pub(crate) fn seen_box(&self, tile: &Tile, heights: [f64; 2]) -> [[f64; 2]; 2] {
        let rows = [tile.rows.start, tile.rows.end];
        let corners = rows.map(|row| {
            [tile.columns.start, tile.columns.end]
                .map(|column| self.corners[row * (self.columns + 1) + column])
        });
        let at = |z: &f64| {
            corners
                .as_flattened()
                .iter()
                .map(|slope| {
                    Ray {
                        origin: self.origin,
                        slope: *slope,
                    }
                    .at(*z)
                })
                .collect::<Vec<_>>()
        };
        let points: Vec<[f64; 2]> = heights.iter().flat_map(at).collect();
        let [low, high] = [f64::min, f64::max]
            .map(|f| [0, 1].map(|k| points.iter().map(|point| point[k]).reduce(f).unwrap_or(0.0)));
        // the lens bends a tile's sides, by far less than this
        let margin = 0.1 * (high[0] - low[0]).max(high[1] - low[1]);
        [low.map(|x| x - margin), high.map(|x| x + margin)]
    }

    /// Renders a tile of an image of subpixels: one whose corners see one grey throughout the
    /// exposure has that grey, any other the mean over its rays.
    pub(crate) fn render(&self, view: &impl View, tile: &Tile, shifts: Draw, image: &mut [f32]) {
        let mut above = self.corner_greys(view, tile, tile.rows.start);
        for row in tile.rows.clone() {
            let below = self.corner_greys(view, tile, row + 1);
            for (i, column) in tile.columns.clone().enumerate() {
                let [grey, others @ ..] = [above[i], above[i + 1], below[i], below[i + 1]];
                // NaN, for a corner that sees several greys, equals nothing
                let even = others.iter().all(|other| *other == grey);
                image[row * self.columns + column] = if even {
                    grey
                } else {
                    self.mean(view, column, row, shifts)
                };
            }
            above = below;
        }
    }

    /// Greys at the corners above a row, or NaN where the grey changes during the exposure.
    fn corner_greys(&self, view: &impl View, tile: &Tile, row: usize) -> Vec<f32> {
        let instants = if view.is_static() {
            &PROBES[..1]
        } else {
            &PROBES
        };
        let at = |column: usize| {
            let ray = Ray {
                origin: self.origin,
                slope: self.corners[row * (self.columns + 1) + column],
            };
            let first = view.grey(&ray, instants[0]);
            if instants[1..]
                .iter()
                .all(|instant| view.grey(&ray, *instant) == first)
            {
                first
            } else {
                f32::NAN
            }
        };
        (tile.columns.start..=tile.columns.end).map(at).collect()
    }

    /// The mean over a subpixel's rays, cast at different points of it and instants.
    fn mean(&self, view: &impl View, column: usize, row: usize, shifts: Draw) -> f32 {
        let number = FIRST_DRAW + (row * self.columns + column) as u32;
        let shift = [shifts.uniform(number, 0), shifts.uniform(number, 1)];
        let first = row * (self.columns + 1) + column;
        let second = first + self.columns + 1;
        let corners = [
            self.corners[first],
            self.corners[first + 1],
            self.corners[second],
            self.corners[second + 1],
        ];
        let first_instant = row % SUBPIXELS * SUBPIXELS + column % SUBPIXELS;
        let mut sum = 0.0;
        for (ray, offset) in self.offsets.iter().enumerate() {
            let [x, y] = [wrap(offset[0] + shift[0]), wrap(offset[1] + shift[1])];
            // within a subpixel the slope is as good as bilinear
            let slope = std::array::from_fn(|k| {
                let along = |a: [f64; 2], b: [f64; 2]| a[k] + x * (b[k] - a[k]);
                along(corners[0], corners[1]) * (1.0 - y) + along(corners[2], corners[3]) * y
            });
            sum += view.grey(
                &Ray {
                    origin: self.origin,
                    slope,
                },
                first_instant + ray * SUBPIXELS * SUBPIXELS,
            );
        }
        sum / RAYS as f32
    }
}

/// A Kronecker sequence that fills the unit square evenly, and the cube with the ray's number as
/// third axis (Roberts 2018: powers of the root of x³ = x + 1).
fn offsets() -> Vec<[f64; 2]> {
    const ROOT: f64 = 1.324_717_957_244_746;
    (0..RAYS)
        .map(|k| [wrap(k as f64 / ROOT), wrap(k as f64 / (ROOT * ROOT))])
        .collect()
}

/// The fraction of a number that is not negative.
fn wrap(x: f64) -> f64 {
    x - f64::from(x as u32)
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;
    use crate::lens::Lens;

    const ROWS: usize = 100;

    /// Bright where x is below an edge, which moves by `travel` (m) over the exposure.
    struct Edge {
        at: f64,
        travel: f64,
    }

    impl View for Edge {
        fn grey(&self, ray: &Ray, instant: usize) -> f32 {
            let edge = self.at + self.travel * (instant as f64 + 0.5) / INSTANTS as f64;
            if ray.at(0.0)[0] < edge { 1.0 } else { 0.0 }
        }

        fn is_static(&self) -> bool {
            self.travel == 0.0
        }
    }

    /// A camera straight above whose pixels are 1 mm, the middle of the first one at (0, 0).
    fn sampler() -> Sampler {
        let lens = Lens {
            size: [20, ROWS as u32],
            focal: [1000.0; 2],
            centre: [0.0; 2],
            radial: [0.0; 2],
            tangential: [0.0; 2],
        };
        Sampler::new(&Camera::look_at(lens, [0.0, 0.0, 1.0], [0.0, 0.0]).unwrap())
    }

    /// Means over the pixels' subpixels.
    fn rendered(view: &Edge) -> Vec<f32> {
        let mut image = vec![0.0; 20 * ROWS * SUBPIXELS * SUBPIXELS];
        sampler()
            .tiles()
            .for_each(|tile| sampler().render(view, &tile, Streams::new(1).at(0), &mut image));
        let mut pixels = vec![0.0; 20 * ROWS];
        for (index, grey) in image.iter().enumerate() {
            let [column, row] =
                [index % (20 * SUBPIXELS), index / (20 * SUBPIXELS)].map(|fine| fine / SUBPIXELS);
            pixels[row * 20 + column] += grey / (SUBPIXELS * SUBPIXELS) as f32;
        }
        pixels
    }

    #[test]
    fn render_covers_a_pixel_by_the_share_that_is_seen() {
        for share in [0.1, 0.25, 0.5, 0.9] {
            let image = rendered(&Edge {
                at: (4.5 + share) * 1e-3,
                travel: 0.0,
            });
            for row in image.chunks(20) {
                assert!(
                    row[..5].iter().all(|v| *v == 1.0) && row[6..].iter().all(|v| *v == 0.0),
                    "{row:?}"
                );
                assert!((f64::from(row[5]) - share).abs() < 0.1, "{share} {row:?}");
            }
            let mean = image
                .chunks(20)
                .fold(0.0, |sum, row| sum + f64::from(row[5]))
                / ROWS as f64;
            assert!((mean - share).abs() < 0.01, "{share} {mean}");
        }
    }

    /// An edge that moves over four pixels leaves a ramp with those four steps.
    #[test]
    fn render_smears_what_moves_over_its_travel() {
        let image = rendered(&Edge {
            at: 4.5e-3,
            travel: 4e-3,
        });
        for (column, expected) in [
            (4, 1.0),
            (5, 0.875),
            (6, 0.625),
            (7, 0.375),
            (8, 0.125),
            (9, 0.0),
        ] {
            let mean = image
                .chunks(20)
                .fold(0.0, |sum, row| sum + f64::from(row[column]))
                / ROWS as f64;
            assert!((mean - expected).abs() < 0.005, "{column}: {mean}");
        }
    }

    #[test]
    fn tiles_are_all_subpixels_once() {
        let mut seen = vec![0; 20 * ROWS * SUBPIXELS * SUBPIXELS];
        for Tile { columns, rows } in sampler().tiles() {
            rows.for_each(|row| {
                columns
                    .clone()
                    .for_each(|column| seen[row * 20 * SUBPIXELS + column] += 1)
            });
        }
        assert!(seen.iter().all(|count| *count == 1));
    }
}
