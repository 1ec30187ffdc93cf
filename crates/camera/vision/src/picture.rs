//! Images from files: [`read_picture`].

use std::io::Cursor;

use image::{DynamicImage, GrayImage, ImageDecoder, ImageFormat, ImageReader};

/// Most pixels of an image: no camera on a table has more, and few bytes can say that they are
/// more.
const MOST_PIXELS: u64 = 1 << 26;

/// Reason why an image was refused.
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
        "{file}: the {kind} image cannot be decoded: {reason}. Record or copy it again, or take it out of the folder"
    )]
    Broken {
        /// Display name of the file.
        file: String,
        /// Kind of the image.
        kind: String,
        /// Message of the decoder.
        reason: String,
    },
    /// A compressed image of a bag whose bytes are no image of a known kind.
    #[error(
        "{file}: the compressed image, of the format `{format}`, is none that can be read; JPEG and PNG can. {}",
        if .format.contains("Depth") { "This is an image of depths; take the topic of grey or colour images" } else { "Record the raw images, or those of image_transport's plain `compressed`" }
    )]
    Compressed {
        /// Display name of the message.
        file: String,
        /// Format that its publisher states.
        format: String,
    },
    /// A compressed image of a bag that cannot be decoded.
    #[error(
        "{file}: the compressed image, of the format `{format}`, cannot be decoded: {reason}. Leave the message out of the bag, or record again"
    )]
    Undecodable {
        /// Display name of the message.
        file: String,
        /// Format that its publisher states.
        format: String,
        /// Message of the decoder.
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
    let broken = |reason: String| {
        let kind = format
            .extensions_str()
            .first()
            .map_or_else(String::new, |ending| ending.to_uppercase());
        PictureError::Broken {
            file: file(),
            kind,
            reason,
        }
    };
    decode(bytes, format).map_err(broken)
}

/// Reads a compressed image of a bag, JPEG or PNG whatever its `format` is called; `name` is shown
/// in errors.
///
/// # Errors
/// [`PictureError`], with the message's name and what is wrong with it.
pub fn read_compressed(bytes: &[u8], format: &str, name: &str) -> Result<GrayImage, PictureError> {
    let kind = image::guess_format(bytes).ok();
    let Some(kind) = kind.filter(|kind| [ImageFormat::Png, ImageFormat::Jpeg].contains(kind))
    else {
        return Err(PictureError::Compressed {
            file: name.to_owned(),
            format: format.to_owned(),
        });
    };
    decode(bytes, kind).map_err(|reason| PictureError::Undecodable {
        file: name.to_owned(),
        format: format.to_owned(),
        reason,
    })
}

/// The grey levels of an image, or why there are none.
fn decode(bytes: &[u8], format: ImageFormat) -> Result<GrayImage, String> {
    let text = |error: image::ImageError| error.to_string();
    let reader = ImageReader::with_format(Cursor::new(bytes), format);
    let decoder = reader.into_decoder().map_err(text)?;
    let (columns, rows) = decoder.dimensions();
    if u64::from(columns) * u64::from(rows) > MOST_PIXELS {
        return Err(format!(
            "it says it has {columns} x {rows} pixels, and {MOST_PIXELS} are the most"
        ));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(text)?;
    Ok(image.into_luma8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_compressed_goes_by_the_bytes_and_names_what_is_wrong() {
        let mut png = std::io::Cursor::new(Vec::new());
        let image = GrayImage::from_pixel(3, 2, image::Luma([77]));
        image.write_to(&mut png, ImageFormat::Png).unwrap();
        let png = png.into_inner();
        let read = read_compressed(&png, "mono8; png compressed mono8", "m").unwrap();
        assert_eq!(read, image);
        for (bytes, format, words) in [
            (
                &b"P5 1 1 255\n\x07"[..],
                "ppm",
                "of the format `ppm`, is none that can be read",
            ),
            (&[0; 20], "16UC1; compressedDepth", "an image of depths"),
            (&png[..40], "png", "cannot be decoded"),
        ] {
            let text = read_compressed(bytes, format, "bag: /image, message 3");
            let text = text.unwrap_err().to_string();
            assert!(
                text.starts_with("bag: /image, message 3: ") && text.contains(words),
                "{text}"
            );
        }
    }

    /// Fuzzing found a JPEG of 379 bytes that says 65527 x 2808 pixels and takes seconds.
    #[test]
    fn an_image_that_says_it_is_huge_is_refused_before_it_is_decoded() {
        let mut jpeg = std::io::Cursor::new(Vec::new());
        let image = GrayImage::from_pixel(8, 8, image::Luma([77]));
        image.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        let mut jpeg = jpeg.into_inner();
        assert!(read_picture(&jpeg, "a.jpg").is_ok());
        // rows and columns stand behind the start of the frame, its length and its depth
        let frame = jpeg.windows(2).position(|two| two == [0xff, 0xc0]).unwrap();
        jpeg[frame + 5..frame + 9].copy_from_slice(&[0xff, 0xf0, 0x0a, 0xf8]);
        for text in [
            read_picture(&jpeg, "a.jpg").unwrap_err().to_string(),
            read_compressed(&jpeg, "jpeg", "a.jpg")
                .unwrap_err()
                .to_string(),
        ] {
            assert!(
                text.contains("it says it has 2808 x 65520 pixels"),
                "{text}"
            );
        }
    }

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
                && text.contains("again"),
            "{text}"
        );
        let webp = b"RIFF\x00\x00\x00\x00WEBPVP8 ";
        assert!(matches!(
            read_picture(webp, "a.webp"),
            Err(PictureError::Unknown { .. })
        ));
    }
}
