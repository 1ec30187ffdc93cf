//! From frames to the poses of object and pusher: [`track`], and [`FrameTracker`] for frames that
//! come one after the other.

use image::GrayImage;
use rayon::prelude::*;
use stickslip_dynamics::Pose;

use crate::camera::Camera;
use crate::detector::{Detector, FoundTag};
use crate::planar_pose::Measurement;
use crate::tags::{BodyTag, Tags};

/// Frames that share a detector.
const CHUNK: usize = 32;

/// One body as a frame shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sighting {
    /// Its pose.
    Measured(Measurement),
    /// Its tag is not found.
    Missing,
    /// Its tag is found, but the border fits no square on its plane: partly covered, bent, or
    /// blurred beyond measure.
    Distorted,
    /// Its tag is found at two places.
    Twice,
}

/// Both bodies as a frame shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSighting {
    /// True where the image is that of the frame before: its sightings are older than its time.
    pub repeated: bool,
    /// The object.
    pub object: Sighting,
    /// The pusher.
    pub pusher: Sighting,
    /// Numbers of all tags found, rising.
    pub tags: Vec<u16>,
}

/// Both bodies as all frames show them.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Frame by frame.
    pub frames: Vec<FrameSighting>,
}

/// Reason why the frames give no track.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TrackError {
    /// A frame has another size than those of the calibration.
    #[error(
        "{name}: the image has {found} pixels, the camera was calibrated at {expected}. Use frames of the calibrated camera at its full size, or calibrate again"
    )]
    Size {
        /// The frame.
        name: String,
        /// Its columns × rows.
        found: String,
        /// Those of the calibration.
        expected: String,
    },
    /// No tag at all.
    #[error(
        "no tag of the family 36h11 is in any of the {frames} frames. See whether the tags are sharp, whole with their white margins, and at least 30 pixels wide"
    )]
    NoTag {
        /// Number of frames.
        frames: usize,
    },
    /// A body's tag is nowhere.
    #[error(
        "the {body}'s tag, number {id}, is in none of the {frames} frames; found are: {found}. Correct {body}.tag, or bring the tag into view"
    )]
    WrongTag {
        /// `object` or `pusher`.
        body: &'static str,
        /// Number of its tag.
        id: u16,
        /// Number of frames.
        frames: usize,
        /// The tags found, and in how many frames.
        found: String,
    },
}

/// Result of one image, with its hash.
struct ProcessedFrame {
    digest: u64,
    sighting: FrameSighting,
}

/// Tracks object and pusher through the frames 0 to `count` - 1, which `load` brings as a name and
/// an image, from any thread.
///
/// # Errors
/// Those of `load`; a frame of another size; no tag, or a body's tag, in no frame at all.
pub fn track<E: From<TrackError> + Send>(
    count: usize,
    load: impl Fn(usize) -> Result<(String, GrayImage), E> + Sync,
    camera: &Camera,
    tags: &Tags,
) -> Result<Track, E> {
    let mut tracker = FrameTracker::new(camera, tags);
    tracker.push(count, load)?;
    Ok(tracker.finish(0..count)?)
}

/// Tracks object and pusher through frames that come in parts, so that not all of them need to be
/// in memory. However they are parted, the track is the same.
pub struct FrameTracker<'c> {
    camera: &'c Camera,
    tags: &'c Tags,
    seen: Vec<ProcessedFrame>,
}

impl<'c> FrameTracker<'c> {
    /// Before the first frame.
    pub fn new(camera: &'c Camera, tags: &'c Tags) -> Self {
        Self {
            camera,
            tags,
            seen: Vec::new(),
        }
    }

    /// Takes `count` more frames, which `load` brings by their number among these, as a name and an
    /// image, from any thread.
    ///
    /// # Errors
    /// Those of `load`; a frame of another size.
    pub fn push<E: From<TrackError> + Send>(
        &mut self,
        count: usize,
        load: impl Fn(usize) -> Result<(String, GrayImage), E> + Sync,
    ) -> Result<(), E> {
        let (camera, tags) = (self.camera, self.tags);
        let chunk = |chunk: usize| {
            let detector = Detector::new(camera.lens().size);
            let frames = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            frames
                .map(|index| process(&detector, load(index)?, camera, tags).map_err(E::from))
                .collect::<Result<Vec<ProcessedFrame>, E>>()
        };
        let seen: Vec<Vec<ProcessedFrame>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(chunk)
            .collect::<Result<_, E>>()?;
        self.seen.extend(seen.into_iter().flatten());
        Ok(())
    }

    /// The track, with the frames in the order of their numbers in `order`.
    ///
    /// # Errors
    /// No tag, or a body's tag, in no frame at all.
    ///
    /// # Panics
    /// If a number in `order` is that of no frame.
    pub fn finish(self, order: impl IntoIterator<Item = usize>) -> Result<Track, TrackError> {
        let mut before = None;
        let frames = order.into_iter().map(|index| {
            let ProcessedFrame { digest, sighting } = &self.seen[index];
            FrameSighting {
                repeated: before.replace(*digest) == Some(*digest),
                ..sighting.clone()
            }
        });
        let track = Track {
            frames: frames.collect(),
        };
        track.check(self.tags)?;
        Ok(track)
    }
}

/// Finds both bodies in one image.
fn process(
    detector: &Detector,
    (name, image): (String, GrayImage),
    camera: &Camera,
    tags: &Tags,
) -> Result<ProcessedFrame, TrackError> {
    let (size, expected) = ([image.width(), image.height()], camera.lens().size);
    if size != expected {
        let text = |[columns, rows]: [u32; 2]| format!("{columns} x {rows}");
        return Err(TrackError::Size {
            name,
            found: text(size),
            expected: text(expected),
        });
    }
    let found = detector.find(&image);
    let sighting = FrameSighting {
        repeated: false,
        object: measure(&found, &tags.object, camera),
        pusher: measure(&found, &tags.pusher, camera),
        tags: found.iter().map(|tag| tag.id).collect(),
    };
    Ok(ProcessedFrame {
        digest: digest(&image),
        sighting,
    })
}

/// The pose of one body.
fn measure(found: &[FoundTag], body: &BodyTag, camera: &Camera) -> Sighting {
    let mut of_body = found.iter().filter(|tag| tag.id == body.id);
    let Some(tag) = of_body.next() else {
        return Sighting::Missing;
    };
    if of_body.next().is_some() {
        return Sighting::Twice;
    }
    let measurement = tag
        .outline
        .fit(camera.lens())
        .and_then(|square| Measurement::of(&square, &body.place, camera));
    measurement.map_or(Sighting::Distorted, Sighting::Measured)
}

impl Track {
    /// Poses of the object by frame, angles without jumps; `None` where there is none, or where the
    /// frame repeats the one before.
    pub fn object(&self) -> Vec<Option<Pose>> {
        self.poses(|frame| frame.object)
    }

    /// Poses of the pusher, likewise.
    pub fn pusher(&self) -> Vec<Option<Pose>> {
        self.poses(|frame| frame.pusher)
    }

    fn poses(&self, body: impl Fn(&FrameSighting) -> Sighting) -> Vec<Option<Pose>> {
        let mut before = 0.0;
        let pose = |frame: &FrameSighting| {
            let Sighting::Measured(Measurement { pose, .. }) = body(frame) else {
                return None;
            };
            before = nearest_turn(pose.theta, before);
            (!frame.repeated).then_some(Pose {
                theta: before,
                ..pose
            })
        };
        self.frames.iter().map(pose).collect()
    }

    /// Refuses a track without one of the bodies.
    fn check(&self, tags: &Tags) -> Result<(), TrackError> {
        let frames = self.frames.len();
        let mut found: Vec<u16> = self
            .frames
            .iter()
            .flat_map(|frame| frame.tags.iter().copied())
            .collect();
        found.sort_unstable();
        if found.is_empty() {
            return Err(TrackError::NoTag { frames });
        }
        let counted = |run: &[u16]| format!("{} ({} times)", run[0], run.len());
        let listed = || {
            found
                .chunk_by(|a, b| a == b)
                .map(counted)
                .collect::<Vec<_>>()
                .join(", ")
        };
        match [("object", tags.object.id), ("pusher", tags.pusher.id)]
            .into_iter()
            .find(|(_, id)| !found.contains(id))
        {
            Some((body, id)) => Err(TrackError::WrongTag {
                body,
                id,
                frames,
                found: listed(),
            }),
            None => Ok(()),
        }
    }
}

/// `angle` plus the whole turns that bring it nearest to `before`.
fn nearest_turn(angle: f64, before: f64) -> f64 {
    angle + std::f64::consts::TAU * ((before - angle) / std::f64::consts::TAU).round()
}

/// Hash of an image (FNV-1a over words of eight bytes); two different images share it with a
/// probability of 1e-19.
fn digest(image: &GrayImage) -> u64 {
    image
        .as_raw()
        .chunks(8)
        .fold(0xcbf2_9ce4_8422_2325, |hash, bytes| {
            let mut word = [0; 8];
            word[..bytes.len()].copy_from_slice(bytes);
            let mixed = (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x0000_0100_0000_01b3);
            mixed ^ mixed >> 32
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_turn_continues_an_angle() {
        assert!((nearest_turn(-3.1, 3.1) - 3.183_185_307).abs() < 1e-8);
        assert_eq!(nearest_turn(0.1, 0.2), 0.1);
        assert!((nearest_turn(0.0, -12.0) + 4.0 * std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn digest_sees_a_single_grey_level() {
        let image = GrayImage::from_pixel(33, 7, image::Luma([100]));
        for index in [0, 1, 7, 8, 115, 230] {
            let mut other = image.clone();
            other.as_mut()[index] = 101;
            assert_ne!(digest(&other), digest(&image), "{index}");
        }
    }
}
