//! Readings of a bag's sensors, in the rows of a log: [`Readings`].

use std::collections::BTreeSet;

use stickslip_dynamics::Pose;

use crate::left_out::{LeftOut, Reason};
use crate::log_mcap::camera_topics::CameraTopics;
use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::images::CameraRecording;
use crate::log_mcap::read::{BagOptions, Reader, damage_warnings};
use crate::log_mcap::rows::{Rows, is_near, span};
use crate::log_mcap::series::{Series, Timed, seconds_text};
use crate::log_mcap::source::CommonFrame;
use crate::log_mcap::topics::Topic;
use crate::log_warning::LogWarning;

/// Readings in the rows of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// One column per touch sensor, as in [`Log`](stickslip::Log).
    pub tactile: Vec<Vec<Option<bool>>>,
    /// Forces (N); empty without a topic of them.
    pub force: Vec<Option<[f64; 2]>>,
    /// Warnings about them.
    pub warnings: Vec<LogWarning>,
}

impl CameraRecording {
    /// Places at which the bag's files were cut off.
    #[must_use]
    pub fn damage(&self) -> Vec<LogWarning> {
        damage_warnings(&self.recording, &self.files)
    }

    /// Readings of sensors in rows at `time` (ns, rising); forces from `touch_force` (N) on are
    /// touches. As in [`read_bag`](crate::read_bag).
    ///
    /// # Errors
    /// Sensors are not numbered without gaps, a mapped one is missing, a message does not fit its
    /// type.
    pub fn readings(
        &self,
        topics: &CameraTopics,
        time: Vec<i64>,
        touch_force: f64,
    ) -> Result<Readings, McapError> {
        let options = BagOptions {
            topics: topics.sensors().clone(),
            touch_force,
            ..BagOptions::default()
        };
        let reader = Reader {
            files: &self.files,
            options: &options,
            recording: &self.recording,
        };
        let sensors = reader.sensors();
        let sensors = sensors.map_err(|problem| reader.whole(problem))?;
        let rows = Rows {
            time,
            ..Rows::default()
        };
        let mut found = Readings::default();
        for topic in (1..=sensors).map(Topic::Fixel) {
            let touches = reader.topic_touches(topic, &mut found.warnings)?;
            let outside = reader.outside(topic, &touches, rows.outside(&touches), rows.ends());
            found.warnings.extend(outside);
            found.tactile.push(rows.touches(&touches));
        }
        let mut frame = CommonFrame::default();
        found.force = reader.forces(&rows, &mut frame, &mut found.warnings)?;
        Ok(found)
    }
}

impl Reader<'_> {
    /// All topics of sensors that are mapped are there; the number of touch sensors.
    pub(crate) fn sensors(&self) -> Result<usize, McapProblem> {
        if self.options.topics.is_mapped(Topic::Wrench) {
            self.require(Topic::Wrench)?;
        }
        self.numbered(Topic::Fixel)
    }

    /// Number of the numbered topics of one `kind`, [`Topic::Fixel`] or [`Topic::Finger`]: all that
    /// are mapped are there, and none is missing between.
    pub(crate) fn numbered(&self, kind: fn(usize) -> Topic) -> Result<usize, McapProblem> {
        let topics = &self.options.topics;
        let recorded = self.recording.topics.keys();
        let known: BTreeSet<Topic> = recorded
            .filter_map(|name| topics.carries(name))
            .chain(topics.mapped())
            .collect();
        let found = (1..=known.len()).take_while(|k| known.contains(&kind(*k)));
        let count = found.count();
        let of_kind = |topic: &&Topic| match topic {
            Topic::Fixel(k) | Topic::Finger(k) => kind(*k) == **topic,
            _ => false,
        };
        for topic in known.iter().filter(of_kind) {
            if topics.is_mapped(*topic) {
                self.require(*topic)?;
            }
        }
        match known.iter().filter(of_kind).count() == count {
            true => Ok(count),
            false => Err(McapProblem::Gap {
                missing: kind(count + 1),
            }),
        }
    }

    /// The readings of `sensors` touch sensors, next to the poses of all bodies.
    pub(crate) fn touches(
        &self,
        sensors: usize,
        (object, fingers): (&[Timed<Pose>], &[Series<Pose>]),
        warnings: &mut Vec<LogWarning>,
    ) -> Result<Vec<Series<bool>>, McapError> {
        let poses = span(object, fingers);
        let mut all = Vec::with_capacity(sensors);
        for topic in (1..=sensors).map(Topic::Fixel) {
            let touches = self.topic_touches(topic, warnings)?;
            let far = touches.iter().filter(|touch| !is_near(touch.time, poses));
            warnings.extend(self.outside(topic, &touches, far.count(), Some(poses)));
            all.push(touches);
        }
        Ok(all)
    }

    fn topic_touches(
        &self,
        topic: Topic,
        warnings: &mut Vec<LogWarning>,
    ) -> Result<Series<bool>, McapError> {
        let Some(source) = self.source(topic) else {
            return Ok(Vec::new());
        };
        let found = source.touches(self.options.touch_force)?;
        let kept = found.readings.len();
        warnings.extend(found.losses.warnings(&self.name(topic), &self.bag(), kept));
        Ok(found.readings)
    }

    /// Forces in the rows (N); none without their topic.
    pub(crate) fn forces(
        &self,
        rows: &Rows,
        frame: &mut CommonFrame,
        warnings: &mut Vec<LogWarning>,
    ) -> Result<Vec<Option<[f64; 2]>>, McapError> {
        let Some(source) = self.source(Topic::Wrench) else {
            return Ok(Vec::new());
        };
        let found = source.forces(frame)?;
        let (kept, topic) = (found.readings.len(), self.name(Topic::Wrench));
        warnings.extend(found.losses.warnings(&topic, &self.bag(), kept));
        let (forces, outside) = (&found.readings, rows.outside(&found.readings));
        warnings.extend(self.outside(Topic::Wrench, forces, outside, rows.ends()));
        Ok(rows.forces(forces))
    }

    /// The warning about `count` measurements of a topic that are before or after the poses.
    fn outside<T>(
        &self,
        topic: Topic,
        series: &[Timed<T>],
        count: usize,
        poses: Option<(i64, i64)>,
    ) -> Option<LogWarning> {
        let (first, last, poses) = (series.first()?.time, series.last()?.time, poses?);
        let text = |(from, to)| format!("{} to {} s", seconds_text(from), seconds_text(to));
        (count > 0).then(|| LogWarning::LeftOut {
            file: self.bag(),
            left_out: LeftOut {
                place: self.name(topic),
                count,
                of: series.len(),
                reason: Reason::OtherTime {
                    at: text((first, last)),
                    poses: text(poses),
                },
            },
        })
    }

    /// Name of the bag in warnings.
    fn bag(&self) -> String {
        self.files.first().cloned().unwrap_or_default()
    }
}
