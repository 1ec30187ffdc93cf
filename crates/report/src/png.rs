//! Figures as pixels: [`png_of`].

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::lettering::outlined;

/// Reason why an SVG gave no pixels.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The text is no SVG.
    #[error("the picture is no SVG: {0}; give the text of a whole SVG document")]
    NoSvg(String),
    /// The picture is too large.
    #[error(
        "a picture of {width} x {height} pixels cannot be held; draw it smaller or with a smaller scale"
    )]
    TooLarge {
        /// Width (px).
        width: u32,
        /// Height (px).
        height: u32,
    },
}

/// Pixels for every pixel of the SVG: 300 dpi where a figure of 780 px is 130 mm wide.
const SCALE: f32 = 2.0;

/// Largest number of pixels.
const LARGEST: u64 = 100_000_000;

/// A figure as a PNG with twice as many pixels each way as the SVG has, in the program's own fonts
/// on any machine.
///
/// # Errors
/// The text is no SVG, or its pixels could not be held.
pub fn png_of(svg: &str) -> Result<Vec<u8>, PngError> {
    let svg = outlined(svg).map_err(|error| PngError::NoSvg(error.to_string()))?;
    let tree = Tree::from_str(&svg, &Options::default())
        .map_err(|error| PngError::NoSvg(error.to_string()))?;
    let size = tree.size();
    let [width, height] =
        [size.width(), size.height()].map(|length| (SCALE * length).ceil() as u32);
    let too_large = PngError::TooLarge { width, height };
    if u64::from(width) * u64::from(height) > LARGEST {
        return Err(too_large);
    }
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| too_large.clone())?;
    resvg::render(
        &tree,
        Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(|_| too_large)
}
