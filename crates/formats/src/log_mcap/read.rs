//! From a recording to a log: [`read_log_mcap`].

use std::collections::BTreeSet;
use std::io::Read;

use stickslip::Log;
use stickslip_dynamics::Pose;

use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::message::SECOND;
use crate::log_mcap::recording::Recording;
use crate::log_mcap::rows::Rows;
use crate::log_mcap::series::{CommonFrame, Series, Source, Tilt, Timed, seconds_text};
use crate::log_mcap::topics::{Topic, Topics};
use crate::log_warning::LogWarning;
use crate::nearest::nearest;

/// Reads a log from an MCAP recording of ROS 2 messages; `name` is shown in errors and warnings.
///
/// Poses are `geometry_msgs/msg/PoseStamped`, forces `geometry_msgs/msg/WrenchStamped`, tactile
/// readings `std_msgs/msg/Bool`. Time (s) is `header.stamp`, of tactile readings the log time. A
/// row stands at every stamp of the object, and at those of the pusher that are more than 1 ms from
/// one. The pusher is interpolated between poses at most 0.2 s apart. A tactile cell is 1 if any
/// reading in the interval that ends at its row is true, 0 if there are only false ones, without
/// any the last one if it is at most 0.5 s old; a force cell is the interval's mean. The first
/// row's interval is as long as the second's. θ = 2 atan2(q_z, q_w), unwrapped.
///
/// The file is read piece by piece; memory is taken for one chunk of at most 256 MiB, and for the
/// messages of the needed topics.
///
/// A recording that is cut off or damaged is read up to there, with a warning for which
/// [`LogWarning::is_loss`] holds.
///
/// # Errors
/// The bytes are no MCAP file or cannot be read; the topic of object or pusher, or one that is mapped, is missing;
/// sensors are not numbered without gaps; a topic has messages of another type or encoding; a
/// number is not finite, an orientation no rotation; two messages of a topic have one stamp; frames
/// differ; there is no pose at all.
pub fn read_log_mcap(
    file: impl Read,
    name: &str,
    topics: &Topics,
) -> Result<(Log, Vec<LogWarning>), McapError> {
    let whole = |problem| McapError {
        file: name.to_owned(),
        place: None,
        problem: Box::new(problem),
    };

    // the messages, up to where the recording is damaged, and whether all topics are there
    let recording = Recording::read(file, topics).map_err(whole)?;
    let reader = Reader {
        file: name,
        topics,
        recording: &recording,
    };
    let mut warnings = reader.damage();
    let sensors = reader.check_topics().map_err(whole)?;

    // poses make the rows
    let mut frame = CommonFrame::default();
    let mut poses = |topic| reader.poses(topic, &mut frame, &mut warnings);
    let (object, pusher) = (poses(Topic::Object)?, poses(Topic::Pusher)?);
    let rows = Rows::new(&object, &pusher);
    let time = reader.times(&rows).map_err(whole)?;

    // sensors fill cells in them
    let mut tactile = Vec::new();
    for topic in (1..=sensors).map(Topic::Fixel) {
        let touches = reader
            .source(topic)
            .map_or(Ok(Vec::new()), |source| source.touches())?;
        tactile.push(rows.touches(&touches));
        warnings.extend(reader.elsewhere(topic, &touches, &rows));
    }
    let force = match reader.source(Topic::Wrench) {
        Some(wrench) => {
            let forces = wrench.forces(&mut frame)?;
            warnings.extend(reader.elsewhere(Topic::Wrench, &forces, &rows));
            rows.forces(&forces)
        }
        None => Vec::new(),
    };
    Ok((
        Log {
            time,
            object: rows.object,
            pusher: rows.pusher,
            tactile,
            force,
        },
        warnings,
    ))
}

/// A recording with its name and those of its topics.
struct Reader<'a> {
    file: &'a str,
    topics: &'a Topics,
    recording: &'a Recording,
}

impl<'a> Reader<'a> {
    /// The warning about where the recording ends too early.
    fn damage(&self) -> Vec<LogWarning> {
        let damage = self.recording.damage.iter();
        damage
            .map(|damage| LogWarning::CutOff {
                file: self.file.to_owned(),
                at: damage.at,
                size: damage.size,
                why: damage.why.clone(),
            })
            .collect()
    }

    /// All needed topics are there; the number of sensors.
    fn check_topics(&self) -> Result<usize, McapProblem> {
        let fixels: BTreeSet<usize> = self
            .recording
            .topics
            .keys()
            .filter_map(fixel)
            .chain(self.topics.mapped_fixels())
            .collect();
        let mapped = fixels
            .iter()
            .map(|k| Topic::Fixel(*k))
            .chain([Topic::Wrench])
            .filter(|topic| self.topics.is_mapped(*topic));
        for topic in [Topic::Object, Topic::Pusher].into_iter().chain(mapped) {
            if !self.recording.topics.contains_key(&topic) {
                return Err(self.missing(topic));
            }
        }
        match (1..).zip(&fixels).find(|(expected, k)| expected != *k) {
            Some((missing, _)) => Err(McapProblem::SensorNumber { missing }),
            None => Ok(fixels.len()),
        }
    }

    fn missing(&self, topic: Topic) -> McapProblem {
        let (name, found) = (self.name(topic), &self.recording.names);
        if let Some(damage) = self.recording.damage.as_ref().filter(|_| found.is_empty()) {
            return McapProblem::Unreadable {
                why: damage.why.clone(),
            };
        }
        let free = found
            .iter()
            .map(String::as_str)
            .filter(|name| self.topics.carries(name).is_none());
        let hint = nearest(&name, free).filter(|(_, distance)| *distance <= name.len() / 2);
        let hint = hint.map_or(String::new(), |(nearest, _)| {
            format!(", the nearest is `{nearest}`")
        });
        let damage = self
            .recording
            .damage
            .as_ref()
            .map(|damage| format!(", and the recording is cut off after {} bytes", damage.at));
        let hint = hint + &damage.unwrap_or_default();
        McapProblem::MissingTopic {
            topic,
            name,
            hint,
            found: found.iter().cloned().collect(),
        }
    }

    fn name(&self, topic: Topic) -> String {
        self.topics.name(topic).unwrap_or_default()
    }

    fn source(&self, topic: Topic) -> Option<Source<'a>> {
        let content = self.recording.topics.get(&topic)?;
        Some(Source {
            file: self.file,
            name: self.name(topic),
            content,
        })
    }

    fn poses(
        &self,
        topic: Topic,
        frame: &mut CommonFrame,
        warnings: &mut Vec<LogWarning>,
    ) -> Result<Series<Pose>, McapError> {
        let Some(source) = self.source(topic) else {
            return Ok(Vec::new());
        };
        let (poses, Tilt { count, largest }) = source.poses(frame)?;
        if count > 0 {
            let (file, topic) = (self.file.to_owned(), source.name);
            warnings.push(LogWarning::Tilted {
                file,
                topic,
                count,
                of: poses.len(),
                largest,
            });
        }
        Ok(poses)
    }

    /// Times of the rows (s).
    fn times(&self, rows: &Rows) -> Result<Vec<f64>, McapProblem> {
        if rows.time.is_empty() {
            return Err(McapProblem::NoRows {
                object: self.name(Topic::Object),
                pusher: self.name(Topic::Pusher),
            });
        }
        // stamps that are not rounded as integers are rounded once
        let time: Vec<f64> = rows
            .time
            .iter()
            .map(|time| *time as f64 / SECOND as f64)
            .collect();
        match time.array_windows().find(|[before, after]| before >= after) {
            Some([time, _]) => Err(McapProblem::SameTime { time: *time }),
            None => Ok(time),
        }
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
        let (file, topic) = (self.file.to_owned(), self.name(topic));
        apart.then(|| LogWarning::Elsewhere {
            file,
            topic,
            at: text(first, last),
            rows: text(begin, end),
        })
    }
}

fn fixel(topic: &Topic) -> Option<usize> {
    if let Topic::Fixel(k) = topic {
        Some(*k)
    } else {
        None
    }
}
