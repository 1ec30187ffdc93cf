//! Where tags are in an image, roughly: [`Detector`], around the library's detector.

use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex, PoisonError};

use image::GrayImage;
use kornia_apriltag::decoder::Detection;
use kornia_apriltag::family::TagFamilyKind;
use kornia_apriltag::{AprilTagDecoder, DecodeTagsConfig};
use kornia_image::{Image, ImageSize};

use crate::outline::Outline;

/// No tag is found in images smaller than this, and the library takes none (px).
const SMALLEST: usize = 32;

/// Finds tags of the family 36h11 in images of one size.
pub struct Detector {
    decoder: Arc<Mutex<AprilTagDecoder>>,
    size: ImageSize,
    /// The library divides an image among the threads that it finds, and its last digits depend on
    /// their number: it gets one.
    one_thread: rayon::ThreadPool,
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
    ///
    /// # Panics
    /// If a side is 0 or above 65535, or the system gives no thread.
    pub fn new(size: [u32; 2]) -> Self {
        // the library looks at every second pixel by default; at full resolution it misses tags
        let config = DecodeTagsConfig::new(vec![TagFamilyKind::Tag36H11])
            .expect("the library has this family");
        let size = ImageSize {
            width: size[0] as usize,
            height: size[1] as usize,
        };
        let decoder = AprilTagDecoder::new(config, size).expect("an image of usual size");
        let one_thread = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .panic_handler(|_| ())
            .build()
            .expect("the system gives a thread");
        Self {
            decoder: Arc::new(Mutex::new(decoder)),
            size,
            one_thread,
        }
    }

    /// The tags in an image, by number and then by place; one may be there twice.
    ///
    /// # Panics
    /// If the image has another size.
    pub fn find(&self, image: &GrayImage) -> Vec<FoundTag> {
        if self.size.width.min(self.size.height) < SMALLEST {
            return Vec::new();
        }
        let detections = self.decode(image);
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

    /// Runs the library on its own thread and blocks on a channel. Inside rayon (`install`), a waiting
    /// thread would steal the next frame, which waits in turn, nested until the stack overflows.
    fn decode(&self, image: &GrayImage) -> Vec<Detection> {
        let view =
            Image::new(self.size, image.as_raw().clone()).expect("an image of the detector's size");
        let (found, wait) = sync_channel(1);
        let decoder = Arc::clone(&self.decoder);
        self.one_thread.spawn(move || {
            let mut decoder = decoder.lock().unwrap_or_else(PoisonError::into_inner);
            let detections = decoder
                .decode(&view)
                .expect("an image of the detector's size");
            decoder.clear();
            // the one who asked is gone only if it panicked
            let _ = found.send(detections);
        });
        wait.recv().expect("the library looks through any image")
    }
}

impl FoundTag {
    /// Corners of its black square, roughly (px): lower left, lower right, upper right, upper left,
    /// as printed.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        self.outline.corners
    }
}
