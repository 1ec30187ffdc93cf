//! Images from files: [`read_picture`].

use image::{GrayImage, ImageFormat};

/// Why an image was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The bytes are no image of a known kind.
    #[error(
        "{file}: its first bytes are those of no image that can be read; PNG, JPEG, BMP and PNM can. Convert it to PNG, or take it out of the folder"
    )]
    Unknown {
        /// Display name of the file.
        file: String,
    },
    /// An image that cannot be decoded.
    #[error(
        "{file}: the {kind} image cannot be decoded: {reason}. Record or copy it anew, or take it out of the folder"
    )]
    Broken {
        /// Display name of the file.
        file: String,
        /// What kind of image it is.
        kind: String,
        /// What the decoder says.
        reason: String,
    },
}

/// Reads a PNG, JPEG, BMP or PNM image as grey levels; `name` is shown in errors.
///
/// # Errors
/// [`PictureError`], with the file's name and what is wrong with it.
pub fn read_picture(bytes: &[u8], name: &str) -> Result<GrayImage, PictureError> {
    let file = || name.to_owned();
    let unknown = |_| PictureError::Unknown { file: file() };
    let format = image::guess_format(bytes).map_err(unknown)?;
    if !matches!(
        format,
        ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Bmp | ImageFormat::Pnm
    ) {
        return Err(PictureError::Unknown { file: file() });
    }
    let broken = |error: image::ImageError| {
        let kind = format
            .extensions_str()
            .first()
            .map_or_else(String::new, |ending| ending.to_uppercase());
        PictureError::Broken {
            file: file(),
            kind,
            reason: error.to_string(),
        }
    };
    Ok(image::load_from_memory_with_format(bytes, format)
        .map_err(broken)?
        .into_luma8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_picture_takes_grey_and_colour() {
        let pgm = b"P5 2 1 255\n\x07\xc8";
        assert_eq!(read_picture(pgm, "a.pgm").unwrap().as_raw(), &[7, 200]);
        let ppm = b"P6 1 1 255\n\x64\x64\x64";
        assert_eq!(read_picture(ppm, "a.ppm").unwrap().as_raw(), &[100]);
    }

    #[test]
    fn read_picture_names_what_is_wrong() {
        let text = read_picture(b"time,file\n", "frames/frames.csv")
            .unwrap_err()
            .to_string();
        assert!(
            text.starts_with("frames/frames.csv: its first bytes")
                && text.contains("Convert it to PNG"),
            "{text}"
        );
        let text = read_picture(b"P5 20 10 255\n\x07", "frames/7.pgm")
            .unwrap_err()
            .to_string();
        assert!(
            text.starts_with("frames/7.pgm: the ")
                && text.contains("cannot be decoded")
                && text.contains("anew"),
            "{text}"
        );
        let webp = b"RIFF\x00\x00\x00\x00WEBPVP8 ";
        assert!(matches!(
            read_picture(webp, "a.webp"),
            Err(PictureError::Unknown { .. })
        ));
    }
}
