//! The fonts of every figure, Roboto in two weights (`crates/report/fonts/`), and how wide text is
//! in them.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId};

/// Roboto Regular, reduced to Latin and Greek letters.
pub(crate) const REGULAR: &[u8] = include_bytes!("../fonts/Roboto-Regular.ttf");

/// Roboto Bold, reduced alike.
pub(crate) const BOLD: &[u8] = include_bytes!("../fonts/Roboto-Bold.ttf");

/// `font-family` of figures: with the fonts at hand, or some other where they are not.
pub(crate) const FAMILY: &str = "Roboto, Arial, Helvetica, sans-serif";

/// Weight of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    Bold,
}

static FACES: LazyLock<[Option<Face<'static>>; 2]> =
    LazyLock::new(|| [REGULAR, BOLD].map(|font| Face::parse(font, 0).ok()));

/// Width of a line of text (px) at a font size (px); letters that the font lacks count as half the
/// size.
pub(crate) fn width(text: &str, size: f64, weight: Weight) -> f64 {
    let advance = |letter: char| {
        let (face, glyph) = glyph(letter, weight)?;
        let units = face.glyph_hor_advance(glyph)?;
        Some(f64::from(units) / f64::from(face.units_per_em()))
    };
    size * text
        .chars()
        .fold(0.0, |sum, letter| sum + advance(letter).unwrap_or(0.5))
}

/// A letter's outline, and the font that has it.
pub(crate) fn glyph(letter: char, weight: Weight) -> Option<(&'static Face<'static>, GlyphId)> {
    let face = FACES[weight as usize].as_ref()?;
    Some((face, face.glyph_index(letter)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_grows_with_letters_size_and_weight() {
        // advance widths of Roboto, units of 2048 per em: zero 1151, space 508
        assert!((width("00", 2048.0, Weight::Regular) - 2302.0).abs() < 1e-9);
        assert!((width("0 0", 20.48, Weight::Regular) - 28.10).abs() < 1e-9);
        assert!(width("contact", 14.0, Weight::Bold) > width("contact", 14.0, Weight::Regular));
        assert_eq!(width("\u{4e2d}", 10.0, Weight::Regular), 5.0);
    }
}
