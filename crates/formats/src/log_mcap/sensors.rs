//! Readings of a bag's sensors, in the rows of a log: [`Readings`].

use std::collections::BTreeSet;

use crate::log_mcap::camera_topics::CameraTopics;
use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::images::CameraRecording;
use crate::log_mcap::message::SECOND;
use crate::log_mcap::read::{BagOptions, Reader, damage_warnings};
use crate::log_mcap::rows::Rows;
use crate::log_mcap::series::{Timed, seconds_text};
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
            object: vec![None; time.len()],
            pusher: vec![None; time.len()],
            time,
        };
        reader.readings(sensors, &rows, &mut CommonFrame::default())
    }
}

impl Reader<'_> {
    /// All topics of sensors that are mapped are there; the number of touch sensors.
    pub(crate) fn sensors(&self) -> Result<usize, McapProblem> {
        let topics = &self.options.topics;
        let recorded = self.recording.topics.keys();
        let fixels: BTreeSet<usize> = recorded
            .filter_map(|name| fixel(topics.carries(name)?))
            .chain(topics.mapped_fixels())
            .collect();
        let mapped = fixels
            .iter()
            .map(|k| Topic::Fixel(*k))
            .chain([Topic::Wrench])
            .filter(|topic| topics.is_mapped(*topic));
        for topic in mapped {
            self.require(topic)?;
        }
        match (1..).zip(&fixels).find(|(expected, k)| expected != *k) {
            Some((missing, _)) => Err(McapProblem::SensorNumber { missing }),
            None => Ok(fixels.len()),
        }
    }

    /// The readings of `sensors` touch sensors and of the force.
    pub(crate) fn readings(
        &self,
        sensors: usize,
        rows: &Rows,
        frame: &mut CommonFrame,
    ) -> Result<Readings, McapError> {
        let mut readings = Readings::default();
        for topic in (1..=sensors).map(Topic::Fixel) {
            let touches = self.source(topic).map_or(Ok(Vec::new()), |source| {
                source.touches(self.options.touch_force)
            })?;
            readings.tactile.push(rows.touches(&touches));
            let elsewhere = self.elsewhere(topic, &touches, rows);
            readings.warnings.extend(elsewhere);
        }
        if let Some(wrench) = self.source(Topic::Wrench) {
            let forces = wrench.forces(frame)?;
            let elsewhere = self.elsewhere(Topic::Wrench, &forces, rows);
            readings.warnings.extend(elsewhere);
            readings.force = rows.forces(&forces);
        }
        Ok(readings)
    }

    /// The warning about a topic none of whose measurements is at any row's time.
    fn elsewhere<T>(&self, topic: Topic, series: &[Timed<T>], rows: &Rows) -> Option<LogWarning> {
        let (first, last, begin, end) = (
            series.first()?.time,
            series.last()?.time,
            *rows.time.first()?,
            *rows.time.last()?,
        );
        let apart = last < begin.saturating_sub(SECOND) || first > end;
        let text = |from, to| format!("{} to {} s", seconds_text(from), seconds_text(to));
        let (file, topic) = (
            self.files.first().cloned().unwrap_or_default(),
            self.name(topic),
        );
        apart.then(|| LogWarning::Elsewhere {
            file,
            topic,
            at: text(first, last),
            rows: text(begin, end),
        })
    }
}

fn fixel(topic: Topic) -> Option<usize> {
    if let Topic::Fixel(k) = topic {
        Some(k)
    } else {
        None
    }
}
