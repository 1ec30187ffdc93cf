//! A bag of camera images: [`BagImages`].

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::Result;
use image::GrayImage;
use stickslip_formats::{
    BagImage, BagOptions, BagPicture, CameraMapping, CameraTopics, Readings, read_bag_camera_info,
    read_bag_images,
};
use stickslip_vision::{
    Camera, CameraInfo, FrameTracker, Lens, RawPicture, Tags, Track, read_compressed,
};

use crate::arg_values::ThreadArgs;
use crate::failure::hinted;
use crate::log_files::{LogFiles, is_bag};
use crate::output::talk;
use crate::progress::spinner;
use crate::verdict::Verdict;

/// Images that are processed together, at most; fewer where they reach `BATCH_BYTES`.
const BATCH: usize = 256;
const BATCH_BYTES: usize = 1 << 26;
/// Nanoseconds in a second.
const SECOND: f64 = 1e9;

/// The images of a bag.
pub struct BagImages {
    shown: String,
    files: LogFiles,
    topics: CameraTopics,
}

/// Poses and sensor readings of a bag of images.
pub struct TrackedBag {
    /// Times of the images (s).
    pub time: Vec<f64>,
    /// Poses in them.
    pub track: Track,
    /// Readings of sensors at these times.
    pub readings: Readings,
    /// Says whether all of the bag could be read.
    pub verdict: Verdict,
}

impl BagImages {
    /// The images of a bag by its topics; `None` for a folder of image files.
    pub fn find(path: &Path, mappings: &[CameraMapping]) -> Result<Option<Self>> {
        let lists_images = path.join("frames.csv").is_file();
        if mappings.is_empty() && (lists_images || !(path.is_file() || is_bag(path))) {
            return Ok(None);
        }
        let topics = CameraTopics::new(mappings.iter().cloned()).map_err(|error| {
            let list = format!("see its topics with `stickslip info {}`", path.display());
            hinted(format!("{}: --topic: {error}", path.display()), list)
        })?;
        let files = LogFiles::find(path)?;
        files.require_bag()?;
        let shown = path.display().to_string();
        Ok(Some(Self {
            shown,
            files,
            topics,
        }))
    }

    /// The lens of CameraInfo; `None` without it, and of a camera that was not calibrated.
    pub fn lens(&self) -> Result<Option<Lens>> {
        let Some(info) = read_bag_camera_info(self.files.open_all()?, &self.topics)? else {
            return Ok(None);
        };
        let topic = self.topics.info().unwrap_or_default();
        let of = format!("{}: {topic}", self.shown);
        let info = CameraInfo {
            size: info.size,
            model: info.model,
            distortion: info.distortion,
            matrix: info.matrix,
            binning: info.binning,
            window: info.window,
        };
        let lens = info.lens(&of).map_err(|error| {
            let leave = "leave CameraInfo out with --topic info=, and give the lens of these images in calibration.toml";
            hinted(error.to_string(), leave)
        })?;
        match lens {
            None => talk(format_args!(
                "note: {of}: the camera was not calibrated, so CameraInfo has no lens"
            )),
            Some(lens) if lens.is_distorted() && self.topics.is_rectified() => {
                return Err(hinted(
                    format!(
                        "{}: {} has rectified images by its name, and {topic} the distortion of the images before that",
                        self.shown,
                        self.topics.image()
                    ),
                    "track the raw images; or leave CameraInfo out with --topic info=, and give the lens of the rectified images in calibration.toml: \
                     focal and centre from CameraInfo's P, radial and tangential 0",
                ));
            }
            Some(_) => {}
        }
        Ok(lens)
    }

    /// Object and pusher through all images, piece by piece.
    pub fn track(&self, camera: &Camera, tags: &Tags, threads: &ThreadArgs) -> Result<TrackedBag> {
        let pool = threads.pool()?;
        let progress = spinner("images");
        let mut tracker = FrameTracker::new(camera, tags);
        let (mut stamps, mut batch, mut bytes) = (Vec::new(), Vec::new(), 0);
        let mut look = |batch: &mut Vec<BagImage>| {
            progress.inc(batch.len() as u64);
            let load = |index: usize| {
                let image: &BagImage = &batch[index];
                anyhow::Ok((image.name.clone(), grey(image)?))
            };
            let seen = pool.install(|| tracker.push(batch.len(), load));
            batch.clear();
            seen
        };
        let recording = read_bag_images(self.files.open_all()?, &self.topics, &mut |image| {
            stamps.push(image.stamp);
            bytes += size(&image);
            batch.push(image);
            if batch.len() >= BATCH || bytes >= BATCH_BYTES {
                look(&mut batch)?;
                bytes = 0;
            }
            anyhow::Ok(ControlFlow::Continue(()))
        })?;
        look(&mut batch)?;
        progress.finish_and_clear();
        let mut order: Vec<usize> = (0..stamps.len()).collect();
        order.sort_by_key(|index| stamps[*index]);
        stamps.sort_unstable();
        let track = tracker.finish(order);
        let track =
            track.map_err(|error| anyhow::Error::from(error).context(self.shown.clone()))?;
        let time = stamps.iter().map(|stamp| *stamp as f64 / SECOND).collect();
        let touch_force = BagOptions::default().touch_force;
        let readings = recording.readings(&self.topics, stamps, touch_force)?;
        let warnings = [recording.damage(), readings.warnings.clone()].concat();
        Ok(TrackedBag {
            time,
            track,
            readings,
            verdict: self.files.told(&warnings),
        })
    }

    /// Number of images.
    pub fn count(&self) -> Result<usize> {
        let mut count = 0;
        read_bag_images(self.files.open_all()?, &self.topics, &mut |_| {
            count += 1;
            anyhow::Ok(ControlFlow::Continue(()))
        })?;
        Ok(count)
    }

    /// The images with these rising numbers among those of the bag, from 1, and their names.
    pub fn frames(&self, numbers: &[usize]) -> Result<Vec<(String, GrayImage)>> {
        let (mut count, mut found) = (0, Vec::with_capacity(numbers.len()));
        read_bag_images(self.files.open_all()?, &self.topics, &mut |image| {
            count += 1;
            if numbers.get(found.len()) == Some(&count) {
                found.push((image.name.clone(), grey(&image)?));
            }
            anyhow::Ok(match found.len() == numbers.len() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        })?;
        match numbers.get(found.len()) {
            None => Ok(found),
            Some(number) => Err(hinted(
                format!(
                    "{}: {} has {count} images, and number {number} was asked for",
                    self.shown,
                    self.topics.image()
                ),
                format!("give a number from 1 to {count}"),
            )),
        }
    }

    /// The image with a number among those of the bag, from 1, and its name.
    pub fn frame(&self, number: usize) -> Result<(String, GrayImage)> {
        Ok(self.frames(&[number])?.remove(0))
    }
}

/// Bytes that an image takes in memory.
fn size(image: &BagImage) -> usize {
    match &image.picture {
        BagPicture::Compressed { bytes, .. } | BagPicture::Raw { bytes, .. } => bytes.len(),
    }
}

/// The grey levels of an image.
fn grey(image: &BagImage) -> Result<GrayImage> {
    match &image.picture {
        BagPicture::Compressed { format, bytes } => {
            Ok(read_compressed(bytes, format, &image.name)?)
        }
        BagPicture::Raw {
            size,
            encoding,
            step,
            is_big_endian,
            bytes,
        } => {
            let raw = RawPicture {
                size: *size,
                encoding: encoding.clone(),
                step: *step,
                is_big_endian: *is_big_endian,
                bytes: bytes.clone(),
            };
            Ok(raw.grey(&image.name)?)
        }
    }
}
