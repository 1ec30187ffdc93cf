//! A recorded motion before the camera: [`Film`], frame by frame.

use std::f64::consts::{PI, SQRT_2};
use std::ops::Range;

use image::GrayImage;
use stickslip_dynamics::{Pose, Scene};

use super::grabber::Grabber;
use super::stage::{Props, TagMount};
use super::studio::{Actors, Shutter, Studio};

/// Time that the hand takes to come and to go (s).
const REACH_TIME: f64 = 0.35;
/// Way that it comes (m).
const REACH: f64 = 0.30;
/// The hand's middle is this far past the tag it covers, seen from the pusher, whose own tag it
/// leaves free (m).
const PAST: f64 = 0.022;

/// Where object and pusher are, one entry per frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Middle of the exposure (s), strictly rising.
    pub time: Vec<f64>,
    /// The object.
    pub object: Vec<Pose>,
    /// The pusher; `None` is out of the picture.
    pub pusher: Vec<Option<Pose>>,
}

/// How a motion is filmed.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Time that the shutter is open (s).
    pub exposure: f64,
    /// The frame grabber.
    pub grabber: Grabber,
    /// Frames in which the hand covers the object's tag; empty for none.
    pub covered: Range<usize>,
    /// Height of the hand (m), where it crosses the line of sight.
    pub hand_height: f64,
}

/// A motion before a camera.
#[derive(Clone, Debug)]
pub struct Film<'a> {
    /// The camera before the stage.
    pub studio: &'a Studio,
    /// What happens.
    pub recorded: &'a Recorded,
    /// How it is filmed.
    pub take: Take,
}

impl Recorded {
    /// A box about all that happens, the tags and all fixels: its lower left and upper right corner
    /// (m).
    pub fn bounds(&self, scene: &Scene, props: &Props) -> [[f64; 2]; 2] {
        let tag_reach = |mount: &Option<TagMount>| {
            mount.map_or(0.0, |m| {
                libm::hypot(m.pose.x, m.pose.y) + m.tag.print_size() / SQRT_2
            })
        };
        let reach = |radius: f64| move |pose: &Pose| (pose.x, pose.y, radius);
        let objects = self.object.iter().map(reach(
            scene
                .object
                .shape
                .bounding_radius()
                .max(tag_reach(&props.object_tag)),
        ));
        let pushers = self.pusher.iter().flatten().map(reach(
            scene
                .pusher
                .shape
                .bounding_radius()
                .max(tag_reach(&props.pusher_tag)),
        ));
        let discs = objects.chain(pushers).chain(
            scene
                .fixels
                .iter()
                .map(|f| (f.pose.x, f.pose.y, f.shape.bounding_radius())),
        );
        let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        discs.fold(empty, |[low, high], (x, y, r)| {
            [
                [low[0].min(x - r), low[1].min(y - r)],
                [high[0].max(x + r), high[1].max(y + r)],
            ]
        })
    }

    /// Direction of the pusher's way (rad); zero where it does not move.
    pub fn push_direction(&self) -> f64 {
        let mut seen = self.pusher.iter().flatten();
        let ends = seen.next().zip(seen.next_back());
        ends.map_or(0.0, |(first, last)| {
            libm::atan2(last.y - first.y, last.x - first.x)
        })
    }

    /// Object and pusher at a time: straight between frames, at rest before the first and after the
    /// last.
    fn at(&self, time: f64) -> (Option<Pose>, Option<Pose>) {
        let later = self
            .time
            .partition_point(|t| *t < time)
            .min(self.time.len().saturating_sub(1));
        let earlier = later.saturating_sub(1);
        let step = self.time[later] - self.time[earlier];
        let share = if step > 0.0 {
            ((time - self.time[earlier]) / step).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let pusher = self.pusher[earlier]
            .zip(self.pusher[later])
            .map(|(a, b)| a.interpolate(b, share));
        (
            Some(self.object[earlier].interpolate(self.object[later], share)),
            pusher,
        )
    }
}

impl Film<'_> {
    /// The frame that is delivered as number `index`; a repeated one is that before.
    ///
    /// # Panics
    /// If the motion has no such frame.
    pub fn frame(&self, index: usize) -> GrayImage {
        let shown = self.take.grabber.delivered(index as u64);
        let time = self.recorded.time[shown as usize];
        let at = |time: f64| {
            let (object, pusher) = self.recorded.at(time);
            Actors {
                object,
                pusher,
                hand: object.and_then(|object| self.hand(time, object)),
            }
        };
        let half = self.take.exposure / 2.0;
        self.studio.frame(
            shown,
            &Shutter {
                open: at(time - half),
                close: at(time + half),
            },
        )
    }

    /// The hand at a time, where it is in the picture: its arm comes against the push, its middle
    /// past the object on the line of sight.
    fn hand(&self, time: f64, object: Pose) -> Option<Pose> {
        let Range { start, end } = self.take.covered;
        let from = self.recorded.time.get(start).filter(|_| start < end)?;
        let to = self.recorded.time.get(end - 1).unwrap_or(&f64::INFINITY);
        let away = ((from - time).max(time - to) / REACH_TIME).max(0.0);
        if away > 1.0 {
            return None;
        }
        let push = self.recorded.push_direction();
        let past = Pose::new(0.0, 0.0, push).rotate([PAST + REACH * away, 0.0]);
        let [x, y, _] = self
            .studio
            .camera()
            .on_sight([object.x, object.y, 0.0], self.take.hand_height);
        Some(Pose::new(x + past[0], y + past[1], push + PI))
    }
}
