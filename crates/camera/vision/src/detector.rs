//! Rough places of tags in an image: [`Detector`], of the library's parts.
//!
//! The library's own loop over them goes through a hash map and lets one candidate's grey levels
//! into the next one's, so that its last digits differ from call to call. Here every candidate is
//! independent.

use std::cmp::Ordering::Equal;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use image::GrayImage;
use kornia_apriltag::DecodeTagsConfig;
use kornia_apriltag::decoder::{Detection, GrayModelPair, decode_tags};
use kornia_apriltag::family::TagFamilyKind;
use kornia_apriltag::quad::{Quad, fit_quads};
use kornia_apriltag::segmentation::{find_connected_components, find_gradient_clusters};
use kornia_apriltag::threshold::{TileMinMax, adaptive_threshold};
use kornia_apriltag::union_find::UnionFind;
use kornia_apriltag::utils::Pixel;
use kornia_image::allocator::CpuAllocator;
use kornia_image::{Image, ImageSize};

use crate::outline::Outline;

/// No tag is found in images smaller than this (px).
const SMALLEST: u32 = 32;

/// Candidates are looked for in every so many-th pixel; at full resolution the library misses tags.
const EVERY: u32 = 2;

/// Side of the tiles of which each has a threshold of its own (px of the smaller image).
const TILE: usize = 4;

type Plane<T> = Image<T, 1, CpuAllocator>;

/// Finds tags of the family 36h11 in images of one size.
pub struct Detector {
    config: DecodeTagsConfig,
    size: [u32; 2],
    /// Copies of the configuration that are not at work: the library writes into one, and it is
    /// large.
    spare: Mutex<Vec<DecodeTagsConfig>>,
}

/// A tag in an image.
#[derive(Clone, Debug)]
pub struct FoundTag {
    /// Its number.
    pub id: u16,
    /// The pixels along its border.
    pub(crate) outline: Outline,
}

impl Detector {
    /// A detector for images of `size`, columns and rows.
    pub fn new(size: [u32; 2]) -> Self {
        let mut config = DecodeTagsConfig::new(vec![TagFamilyKind::Tag36H11]);
        config.downscale_factor = EVERY as usize;
        Self {
            config,
            size,
            spare: Mutex::default(),
        }
    }

    /// The tags in an image, by number and then by place; one may be there twice.
    ///
    /// # Panics
    /// If the image has another size.
    pub fn find(&self, image: &GrayImage) -> Vec<FoundTag> {
        assert_eq!(image.dimensions(), self.size.into(), "the detector's size");
        if self.size[0].min(self.size[1]) < SMALLEST {
            return Vec::new();
        }
        let quads = self.candidates(&every_second(image));
        let detections = self.decode(image, quads);
        let mut tags: Vec<FoundTag> = detections
            .iter()
            .map(|detection| {
                // anti-clockwise from the lower left as printed; the library's y axis points down,
                // its pixels begin at their corner
                let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[x, y]| {
                    let at = detection.quad.homography_project(x, y);
                    [f64::from(at.x) - 0.5, f64::from(at.y) - 0.5]
                });
                FoundTag {
                    id: detection.id,
                    outline: Outline::gather(image, corners),
                }
            })
            .collect();
        tags.sort_by(|a, b| {
            a.id.cmp(&b.id)
                .then(a.corners()[0][0].total_cmp(&b.corners()[0][0]))
        });
        tags
    }

    /// Everything with four corners, in an order that depends on the image alone.
    fn candidates(&self, small: &Plane<u8>) -> Vec<Quad> {
        let fits = "images of one size";
        let mut black_or_white = plane(small.size(), vec![Pixel::Skip; small.as_slice().len()]);
        let mut tiles = TileMinMax::new(small.size(), TILE);
        let contrast = self.config.min_white_black_difference;
        adaptive_threshold(small, &mut black_or_white, &mut tiles, contrast).expect(fits);

        let mut components = UnionFind::new(small.as_slice().len());
        find_connected_components(&black_or_white, &mut components).expect(fits);
        let mut borders = HashMap::new();
        find_gradient_clusters(&black_or_white, &mut components, &mut borders);

        let mut quads = fit_quads(&black_or_white, &mut borders, &self.config);
        let place = |quad: &Quad| quad.corners.map(|corner| [corner.x, corner.y]);
        quads.sort_by(|a, b| {
            let pairs = place(a).into_iter().zip(place(b));
            let mut orders = pairs.map(|(a, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            orders.find(|order| order.is_ne()).unwrap_or(Equal)
        });
        quads
    }

    /// The candidates that are tags, each once.
    fn decode(&self, image: &GrayImage, quads: Vec<Quad>) -> Vec<Detection> {
        let size = ImageSize {
            width: image.width() as usize,
            height: image.height() as usize,
        };
        let image = plane(size, image.as_raw().clone());
        let spare = || self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = spare().pop();
        let mut config = taken.unwrap_or_else(|| self.config.clone());
        let mut found: Vec<Detection> = Vec::new();
        for mut quad in quads {
            let quad = std::slice::from_mut(&mut quad);
            for tag in decode_tags(&image, quad, &mut config, &mut GrayModelPair::new()) {
                match found.iter_mut().find(|other| is_same(other, &tag)) {
                    Some(other) if is_surer(&tag, other) => *other = tag,
                    Some(_) => {}
                    None => found.push(tag),
                }
            }
        }
        spare().push(config);
        found
    }
}

impl FoundTag {
    /// Corners of its black square, roughly (px): lower left, lower right, upper right, upper left,
    /// as printed.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        self.outline.corners
    }
}

fn every_second(image: &GrayImage) -> Plane<u8> {
    let size = [image.width(), image.height()].map(|side| side.div_ceil(EVERY));
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [EVERY * x, EVERY * y]));
    let pixels = pixels.map(|[x, y]| image.get_pixel(x, y).0[0]).collect();
    let [width, height] = size.map(|side| side as usize);
    plane(ImageSize { width, height }, pixels)
}

fn plane<T: Clone>(size: ImageSize, pixels: Vec<T>) -> Plane<T> {
    Image::new(size, pixels, CpuAllocator).expect("as many pixels as the size says")
}

/// Returns true if two candidates are one tag: of one number, and nearer than half a diagonal.
fn is_same(a: &Detection, b: &Detection) -> bool {
    let distance = |a: [f32; 2], b: [f32; 2]| libm::hypotf(a[0] - b[0], a[1] - b[1]);
    let corner = |tag: &Detection, k: usize| [tag.quad.corners[k].x, tag.quad.corners[k].y];
    let diagonal = |tag: &Detection| distance(corner(tag, 0), corner(tag, 2));
    let apart = distance([a.center.x, a.center.y], [b.center.x, b.center.y]);
    a.id == b.id && apart < 0.25 * (diagonal(a) + diagonal(b))
}

fn is_surer(a: &Detection, b: &Detection) -> bool {
    let errors = a.hamming.cmp(&b.hamming);
    errors.is_lt() || errors.is_eq() && a.decision_margin > b.decision_margin
}
