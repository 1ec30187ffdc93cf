//! A recorded motion before the camera: [`Video`], frame by frame.

use std::f64::consts::PI;
use std::ops::Range;

use image::GrayImage;
use stickslip_dynamics::Pose;

use crate::exposure::{BodyPoses, Exposure};
use crate::frame_grabber::FrameGrabber;
use crate::recorded_motion::RecordedMotion;
use crate::renderer::Renderer;

/// Time that the hand takes to come and to go (s).
const APPROACH_TIME: f64 = 0.35;
/// Distance that it comes (m).
const APPROACH: f64 = 0.30;
/// Distance of the hand's middle past the tag it covers, seen from the pusher, whose own tag it
/// leaves free (m).
const PAST_TAG: f64 = 0.022;

/// Settings for the capture of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureSettings {
    /// Time that the shutter is open (s).
    pub exposure: f64,
    /// The frame grabber.
    pub grabber: FrameGrabber,
    /// Frames in which the hand covers the object's tag; empty for none.
    pub covered: Range<usize>,
    /// Height at which the hand crosses the line of sight (m).
    pub hand_height: f64,
}

/// A motion as a camera captures it.
#[derive(Clone, Debug)]
pub struct Video<'a> {
    /// The camera before the scene.
    pub renderer: &'a Renderer,
    /// The motion.
    pub motion: &'a RecordedMotion,
    /// Its settings.
    pub settings: CaptureSettings,
}

impl Video<'_> {
    /// The frame that is delivered as number `index`; a repeated one is that before.
    ///
    /// # Panics
    /// If the motion has no such frame.
    pub fn frame(&self, index: usize) -> GrayImage {
        let shown = self.settings.grabber.delivered(index as u64);
        let time = self.motion.time[shown as usize];
        let poses = |time: f64| {
            let poses = self.motion.at(time);
            let hand = poses.object.and_then(|object| self.hand(time, object));
            BodyPoses { hand, ..poses }
        };
        let half = self.settings.exposure / 2.0;
        let exposure = Exposure {
            start: poses(time - half),
            end: poses(time + half),
        };
        self.renderer.frame(shown, &exposure)
    }

    /// The hand at a time, where it is in the picture. Its arm comes against the push, and its
    /// middle stops on the line of sight to the object and a little past it.
    fn hand(&self, time: f64, object: Pose) -> Option<Pose> {
        let Range { start, end } = self.settings.covered;
        let from = self.motion.time.get(start).filter(|_| start < end)?;
        let to = self.motion.time.get(end - 1).unwrap_or(&f64::INFINITY);
        let away = ((from - time).max(time - to) / APPROACH_TIME).max(0.0);
        if away > 1.0 {
            return None;
        }
        let push = self.motion.push_direction();
        let past = Pose::new(0.0, 0.0, push).rotate([PAST_TAG + APPROACH * away, 0.0]);
        let [x, y, _] = self
            .renderer
            .camera()
            .on_line_of_sight([object.x, object.y, 0.0], self.settings.hand_height);
        Some(Pose::new(x + past[0], y + past[1], push + PI))
    }
}
