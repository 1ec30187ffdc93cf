//! Images as rows of pixels, as cameras deliver them: [`RawPicture`].

use image::{DynamicImage, GrayImage, ImageBuffer};

/// An image as rows of pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawPicture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Encoding of the bytes of a pixel, by its name in ROS.
    pub encoding: String,
    /// Bytes from one row to the next.
    pub step: u32,
    /// True if numbers of two bytes begin with the higher one.
    pub is_big_endian: bool,
    /// The rows.
    pub bytes: Vec<u8>,
}

/// Reason why an image of pixels was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RawPictureError {
    /// An encoding that is not known.
    #[error(
        "{name}: the image is encoded as `{found}`; mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_... of 8 bits and yuv422 can be read. {}",
        if .found.contains("16UC1") || .found.contains("32FC1") { "That is how depths are encoded; take the topic of grey or colour images" } else { "Record the image as one of these, or compressed" }
    )]
    Encoding {
        /// Display name of the image.
        name: String,
        /// The encoding.
        found: String,
    },
    /// No pixel.
    #[error("{name}: the image has {columns} x {rows} pixels. Record images that are not empty")]
    Empty {
        /// Display name of the image.
        name: String,
        /// Its columns.
        columns: u32,
        /// Its rows.
        rows: u32,
    },
    /// Rows that are shorter than their pixels.
    #[error(
        "{name}: a row has {step} bytes (step), and {columns} pixels of `{encoding}` need {least}. Correct what publishes the image"
    )]
    Step {
        /// Display name of the image.
        name: String,
        /// Bytes of a row.
        step: u32,
        /// Pixels in it.
        columns: u32,
        /// Their encoding.
        encoding: String,
        /// Bytes that they need.
        least: u64,
    },
    /// Fewer bytes than rows.
    #[error(
        "{name}: the image has {found} bytes, and {rows} rows of {step} bytes need {least}. Correct what publishes the image"
    )]
    Short {
        /// Display name of the image.
        name: String,
        /// Its bytes.
        found: usize,
        /// Its rows.
        rows: u32,
        /// Bytes of a row.
        step: u32,
        /// Bytes that they need.
        least: u64,
    },
}

/// Layout of a pixel's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pixels {
    /// One byte, its grey level or that of the one colour that it sees.
    Grey,
    /// Two bytes, a grey level.
    Grey16,
    /// Three or four bytes, of which those at these places are red, green and blue.
    Colour { bytes: u32, at: [usize; 3] },
    /// Two bytes, of which that at this place is the brightness.
    Brightness { at: usize },
}

impl Pixels {
    /// By the names of `sensor_msgs/image_encodings.hpp`.
    fn of(encoding: &str) -> Option<Self> {
        let colour = |bytes, at| Some(Self::Colour { bytes, at });
        match encoding {
            "mono8" | "8UC1" | "bayer_rggb8" | "bayer_bggr8" | "bayer_gbrg8" | "bayer_grbg8" => {
                Some(Self::Grey)
            }
            "mono16" => Some(Self::Grey16),
            "rgb8" => colour(3, [0, 1, 2]),
            "bgr8" | "8UC3" => colour(3, [2, 1, 0]),
            "rgba8" => colour(4, [0, 1, 2]),
            "bgra8" | "8UC4" => colour(4, [2, 1, 0]),
            "yuv422" | "uyvy" => Some(Self::Brightness { at: 1 }),
            "yuv422_yuy2" | "yuyv" => Some(Self::Brightness { at: 0 }),
            _ => None,
        }
    }

    fn bytes(self) -> u32 {
        match self {
            Self::Grey => 1,
            Self::Grey16 | Self::Brightness { .. } => 2,
            Self::Colour { bytes, .. } => bytes,
        }
    }
}

impl RawPicture {
    /// Its grey levels, those of an image file with the same pixels; `name` is shown in errors. A
    /// mosaic of colours (bayer) is taken for grey as it is, brightness of yuv422 without its
    /// colour.
    ///
    /// # Errors
    /// [`RawPictureError`]: an encoding that is not known, no pixel, fewer bytes than there must
    /// be.
    pub fn grey(&self, name: &str) -> Result<GrayImage, RawPictureError> {
        let pixels = Pixels::of(&self.encoding).ok_or_else(|| RawPictureError::Encoding {
            name: name.to_owned(),
            found: self.encoding.clone(),
        })?;
        let rows = self.rows(pixels, name)?;
        let grey = match pixels {
            Pixels::Grey => self.image(rows.flatten().copied().collect()),
            Pixels::Brightness { at } => self.image(
                rows.flat_map(|row| row.iter().skip(at).step_by(2))
                    .copied()
                    .collect(),
            ),
            Pixels::Grey16 => {
                let levels =
                    rows.flat_map(|row| row.as_chunks().0)
                        .map(|level| match self.is_big_endian {
                            true => u16::from_be_bytes(*level),
                            false => u16::from_le_bytes(*level),
                        });
                let [columns, rows] = self.size;
                ImageBuffer::from_raw(columns, rows, levels.collect())
                    .map(|image| DynamicImage::ImageLuma16(image).into_luma8())
            }
            Pixels::Colour { bytes, at } => {
                let colours = rows.flat_map(|row| row.chunks_exact(bytes as usize));
                let levels = colours.flat_map(|pixel| at.map(|k| pixel[k]));
                let [columns, rows] = self.size;
                ImageBuffer::from_raw(columns, rows, levels.collect())
                    .map(|image| DynamicImage::ImageRgb8(image).into_luma8())
            }
        };
        // rows have as many pixels as the image has columns
        Ok(grey.unwrap_or_default())
    }

    fn image(&self, levels: Vec<u8>) -> Option<GrayImage> {
        let [columns, rows] = self.size;
        GrayImage::from_raw(columns, rows, levels)
    }

    /// The bytes of each row's pixels.
    fn rows(
        &self,
        pixels: Pixels,
        name: &str,
    ) -> Result<impl Iterator<Item = &[u8]>, RawPictureError> {
        let ([columns, rows], step) = (self.size, self.step);
        let name = || name.to_owned();
        if columns == 0 || rows == 0 {
            return Err(RawPictureError::Empty {
                name: name(),
                columns,
                rows,
            });
        }
        let in_row = u64::from(columns) * u64::from(pixels.bytes());
        if u64::from(step) < in_row {
            return Err(RawPictureError::Step {
                name: name(),
                step,
                columns,
                encoding: self.encoding.clone(),
                least: in_row,
            });
        }
        // what fills up the last row may be missing
        let least = u64::from(rows - 1) * u64::from(step) + in_row;
        let found = self.bytes.len();
        if (found as u64) < least {
            return Err(RawPictureError::Short {
                name: name(),
                found,
                rows,
                step,
                least,
            });
        }
        let rows = self.bytes.chunks(step as usize).take(rows as usize);
        Ok(rows.map(move |row| &row[..in_row as usize]))
    }
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};

    use super::*;

    fn raw(encoding: &str, size: [u32; 2], step: u32, bytes: &[u8]) -> RawPicture {
        RawPicture {
            size,
            encoding: encoding.to_owned(),
            step,
            is_big_endian: false,
            bytes: bytes.to_vec(),
        }
    }

    /// Two rows of two pixels, each row with a byte to spare.
    #[test]
    fn grey_leaves_out_what_fills_up_rows() {
        let picture = raw("mono8", [2, 2], 3, &[1, 2, 99, 3, 4]);
        assert_eq!(picture.grey("a").unwrap().as_raw(), &[1, 2, 3, 4]);
    }

    #[test]
    fn colours_have_the_grey_of_an_image_file_with_them() {
        let colours = [[200, 10, 30], [0, 255, 7]];
        let mut file = RgbImage::new(2, 1);
        for (x, colour) in (0..).zip(colours) {
            file.put_pixel(x, 0, Rgb(colour));
        }
        let expected = DynamicImage::ImageRgb8(file).into_luma8();
        for (encoding, order) in [
            ("rgb8", &[0, 1, 2][..]),
            ("bgr8", &[2, 1, 0]),
            ("rgba8", &[0, 1, 2, 3]),
            ("bgra8", &[2, 1, 0, 3]),
        ] {
            let bytes: Vec<u8> = colours
                .iter()
                .flat_map(|[r, g, b]| order.iter().map(|k| [*r, *g, *b, 128][*k]))
                .collect();
            let picture = raw(encoding, [2, 1], bytes.len() as u32, &bytes);
            assert_eq!(picture.grey("a").unwrap(), expected, "{encoding}");
        }
        // by ITU-R BT.709, which the file's reader says it follows
        let level = |[r, g, b]: [f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((f64::from(expected.as_raw()[0]) - level([200.0, 10.0, 30.0])).abs() < 1.0);
    }

    #[test]
    fn numbers_of_two_bytes_are_read_in_both_orders() {
        let little = raw("mono16", [2, 1], 4, &[0xff, 0xff, 0x00, 0x80]);
        let big = RawPicture {
            is_big_endian: true,
            bytes: vec![0xff, 0xff, 0x80, 0x00],
            ..little.clone()
        };
        assert_eq!(little.grey("a").unwrap().as_raw(), &[255, 128]);
        assert_eq!(big.grey("a").unwrap(), little.grey("a").unwrap());
    }

    #[test]
    fn brightness_is_taken_out_of_yuv() {
        let bytes = [10, 1, 20, 2];
        for (encoding, levels) in [("yuv422_yuy2", [10, 20]), ("yuv422", [1, 2])] {
            let picture = raw(encoding, [2, 1], 4, &bytes);
            assert_eq!(picture.grey("a").unwrap().as_raw(), &levels);
        }
    }

    #[test]
    fn grey_names_what_is_wrong() {
        for (picture, words) in [
            (raw("16UC1", [1, 1], 2, &[0; 2]), "how depths are encoded"),
            (
                raw("nv21", [1, 1], 2, &[0; 2]),
                "Record the image as one of these",
            ),
            (raw("mono8", [0, 4], 0, &[]), "0 x 4 pixels"),
            (
                raw("rgb8", [2, 2], 4, &[0; 8]),
                "a row has 4 bytes (step), and 2 pixels of `rgb8` need 6",
            ),
            (
                raw("mono8", [2, 2], 2, &[0; 3]),
                "the image has 3 bytes, and 2 rows of 2 bytes need 4",
            ),
            (
                raw("bgra8", [u32::MAX, u32::MAX], u32::MAX, &[]),
                "need 17179869180",
            ),
        ] {
            let text = picture
                .grey("bag: /image, message 3")
                .unwrap_err()
                .to_string();
            assert!(
                text.starts_with("bag: /image, message 3: ") && text.contains(words),
                "{text}"
            );
        }
    }
}
