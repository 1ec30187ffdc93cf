//! Frames as files: [`encode_png`].

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, GrayImage, ImageEncoder};

/// A frame as PNG.
///
/// # Panics
/// If memory runs out.
pub fn encode_png(frame: &GrayImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Sub)
        .write_image(
            frame.as_raw(),
            frame.width(),
            frame.height(),
            ExtendedColorType::L8,
        )
        .expect("a grey image of its own size can be written to memory");
    bytes
}
