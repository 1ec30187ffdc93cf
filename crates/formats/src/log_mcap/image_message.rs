//! Messages of a camera: [`BagImage`] and [`BagCameraInfo`].

use serde::Deserialize;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::message::{Header, Message, PADDING, decode, decode_front};
use crate::log_mcap::planar::finite;
use crate::log_mcap::source::stamp;

/// An image of a bag, as it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct BagImage {
    /// File, topic and number of its message, for people.
    pub name: String,
    /// Number of its message among those of the topic in the file, from 1.
    pub number: usize,
    /// `header.stamp` (ns).
    pub stamp: i64,
    /// Its pixels.
    pub picture: BagPicture,
}

/// The pixels of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BagPicture {
    /// `sensor_msgs/msg/CompressedImage`: an image file.
    Compressed {
        /// Format that its publisher states.
        format: String,
        /// The file.
        bytes: Vec<u8>,
    },
    /// `sensor_msgs/msg/Image`: rows of pixels.
    Raw {
        /// Columns and rows.
        size: [u32; 2],
        /// Encoding of a pixel's bytes, as `mono8`.
        encoding: String,
        /// Bytes from one row to the next.
        step: u32,
        /// True if numbers of two bytes begin with the higher one.
        is_big_endian: bool,
        /// The rows.
        bytes: Vec<u8>,
    },
}

/// `sensor_msgs/msg/CameraInfo`: how a camera maps directions to pixels. Rotation and projection,
/// which rectified images have, are not kept.
#[derive(Clone, Debug, PartialEq)]
pub struct BagCameraInfo {
    /// Columns and rows of an image.
    pub size: [u32; 2],
    /// Name of the distortion model, as `plumb_bob`.
    pub model: String,
    /// Its numbers, for plumb_bob k1, k2, p1, p2, k3.
    pub distortion: Vec<f64>,
    /// The camera's matrix K, row by row (px).
    pub matrix: [f64; 9],
    /// Pixels of the sensor that are one of the image, along x and y; 0 is 1.
    pub binning: [u32; 2],
    /// The part of the sensor that is read out: left, top, width, height (px); width and height 0
    /// for all of it.
    pub window: [u32; 4],
}

/// `sensor_msgs/msg/Image` up to its bytes.
#[derive(Deserialize)]
struct ImageFront {
    header: Header,
    height: u32,
    width: u32,
    encoding: String,
    is_bigendian: u8,
    step: u32,
    length: u32,
}

/// `sensor_msgs/msg/CompressedImage` up to its bytes.
#[derive(Deserialize)]
struct CompressedFront {
    header: Header,
    format: String,
    length: u32,
}

/// `sensor_msgs/msg/CameraInfo`, its region of interest laid out flat.
#[derive(Deserialize)]
struct CameraInfo {
    #[serde(rename = "header")]
    _header: Header,
    height: u32,
    width: u32,
    distortion_model: String,
    d: Vec<f64>,
    k: [f64; 9],
    #[serde(rename = "r")]
    _r: [f64; 9],
    #[serde(rename = "p")]
    _p: [f64; 12],
    binning: [u32; 2],
    x_offset: u32,
    y_offset: u32,
    roi_height: u32,
    roi_width: u32,
    #[serde(rename = "do_rectify")]
    _do_rectify: bool,
}

impl Message for ImageFront {
    const TYPE: &'static str = "sensor_msgs/msg/Image";
}

impl Message for CompressedFront {
    const TYPE: &'static str = "sensor_msgs/msg/CompressedImage";
}

impl Message for CameraInfo {
    const TYPE: &'static str = "sensor_msgs/msg/CameraInfo";
}

/// Names of the types that carry an image.
pub(crate) const IMAGE_TYPES: [&str; 2] = [ImageFront::TYPE, CompressedFront::TYPE];
/// Name of the type that carries a camera's numbers.
pub(crate) const INFO_TYPE: &str = CameraInfo::TYPE;

/// The stamp (ns) and the pixels of a message of the type `schema`, one of [`IMAGE_TYPES`].
pub(crate) fn decode_image(schema: &str, bytes: &[u8]) -> Result<(i64, BagPicture), McapProblem> {
    if schema == CompressedFront::TYPE {
        let (front, rest) = decode_front::<CompressedFront>(bytes)?;
        let picture = BagPicture::Compressed {
            format: front.format,
            bytes: counted::<CompressedFront>(front.length, rest)?.to_vec(),
        };
        return Ok((stamp(&front.header.stamp)?, picture));
    }
    let (front, rest) = decode_front::<ImageFront>(bytes)?;
    let picture = BagPicture::Raw {
        size: [front.width, front.height],
        encoding: front.encoding,
        step: front.step,
        is_big_endian: front.is_bigendian != 0,
        bytes: counted::<ImageFront>(front.length, rest)?.to_vec(),
    };
    Ok((stamp(&front.header.stamp)?, picture))
}

/// The bytes that a message ends with, as many as it says.
fn counted<M: Message>(length: u32, rest: &[u8]) -> Result<&[u8], McapProblem> {
    let length = length as usize;
    let whole = rest.get(..length);
    whole
        .filter(|_| rest.len() - length < PADDING)
        .ok_or_else(|| McapProblem::Message {
            expected: M::TYPE,
            why: format!("it says that {length} bytes follow, and {} do", rest.len()),
        })
}

/// The camera's numbers of a message; all are finite.
pub(crate) fn decode_camera_info(bytes: &[u8]) -> Result<BagCameraInfo, McapProblem> {
    let info: CameraInfo = decode(bytes)?;
    for number in &info.d {
        finite([("d", *number)])?;
    }
    for number in info.k {
        finite([("k", number)])?;
    }
    Ok(BagCameraInfo {
        size: [info.width, info.height],
        model: info.distortion_model,
        distortion: info.d,
        matrix: info.k,
        binning: info.binning,
        window: [
            info.x_offset,
            info.y_offset,
            info.roi_width,
            info.roi_height,
        ],
    })
}
