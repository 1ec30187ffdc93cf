//! From a bag to a log: [`read_bag`], [`read_log_mcap`].

use std::collections::BTreeMap;
use std::io::Read;
use std::iter::once;

use stickslip::{Log, PoseCovariance, Tactile};
use stickslip_dynamics::Pose;

use crate::log_mcap::body::{BodyPoses, TaggedBody, joined};
use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::message::{Bool, Message, SECOND, WrenchStamped};
use crate::log_mcap::messages::Damage;
use crate::log_mcap::part::BagPart;
use crate::log_mcap::place::Place;
use crate::log_mcap::planar::Tilt;
use crate::log_mcap::pose_message::PoseKind;
use crate::log_mcap::recording::{Recording, Wanted};
use crate::log_mcap::rows::Rows;
use crate::log_mcap::series::Series;
use crate::log_mcap::source::{CommonFrame, Source};
use crate::log_mcap::topics::{Topic, Topics};
use crate::log_mcap::transforms::Transforms;
use crate::log_warning::LogWarning;
use crate::mounts::Mounts;
use crate::nearest::nearest;

/// Options for reading a bag.
#[derive(Clone, Debug, PartialEq)]
pub struct BagOptions {
    /// Topics of all quantities.
    pub topics: Topics,
    /// Places of tags on object and pusher, where these are read from transforms.
    pub mounts: Mounts,
    /// Part of the recording that is read.
    pub part: BagPart,
    /// Force from which a sensor that gives forces is touched (N).
    pub touch_force: f64,
}

impl Default for BagOptions {
    fn default() -> Self {
        Self {
            topics: Topics::default(),
            mounts: Mounts::default(),
            part: BagPart::default(),
            touch_force: Tactile::default().touch_force,
        }
    }
}

/// Reads a log from one MCAP recording of ROS 2 messages; `name` is shown in errors and warnings.
/// No tags, and sensors by the default force: else as [`read_bag`].
///
/// # Errors
/// Those of [`read_bag`].
pub fn read_log_mcap(
    file: impl Read,
    name: &str,
    topics: &Topics,
) -> Result<(Log, Vec<LogWarning>), McapError> {
    let options = BagOptions {
        topics: topics.clone(),
        ..BagOptions::default()
    };
    read_bag(once((name.to_owned(), file)), &options)
}

/// Reads a log from the MCAP files of a bag of ROS 2 messages, each with the name to show in errors
/// and warnings.
///
/// Poses are `geometry_msgs/msg/PoseStamped`, `PoseWithCovarianceStamped`, `TransformStamped` or
/// `nav_msgs/msg/Odometry`, or the way between two frames of `tf2_msgs/msg/TFMessage`. Forces are
/// `geometry_msgs/msg/WrenchStamped`, tactile readings `std_msgs/msg/Bool` or a force that is
/// compared with a threshold. Time (s) is `header.stamp`, of Bool the log time; messages may come
/// in any order.
///
/// Every pose and every tactile reading is in a row at its own time, and equal times share a row. A
/// reading at most 1 ms after a row that makes a step is in that row, since no step is shorter than
/// [`SHORTEST_STEP`](stickslip::SHORTEST_STEP). Readings more than 1 s before the first pose or
/// after the last one are left out. A force cell is the mean over the interval that ends at its
/// row. The first row's interval is as long as the second's. θ = 2 atan2(q_z, q_w), unwrapped.
///
/// A pose whose quaternion is 0, or with a number that is not finite, was not measured. It is left
/// out, and so is a message that is equal to an earlier one. Transforms on the way between two
/// frames are interpolated over at most 0.2 s. [`LogWarning::left_out`] counts what is left out.
///
/// Where messages of the object have a covariance, that of x, y and the turn about z is the row's.
/// A covariance of zeros counts as unknown. So do numbers that are no covariance, with a warning.
///
/// Files are read piece by piece; memory is taken for one chunk of at most 256 MiB, and for the
/// messages of the needed topics. Files, chunks and messages may be packed with zstd.
///
/// A file that is cut off or damaged is read up to there, with a warning whose
/// [`LogWarning::is_loss`] is true.
///
/// # Errors
/// - The bytes are no MCAP file or cannot be read.
/// - The topic of object or pusher, or one that is mapped, is missing; sensors are not numbered
///   without gaps.
/// - A topic has messages of another type or encoding.
/// - An orientation is no rotation; two different messages of a topic have one stamp.
/// - A clock jumps back: the recording has several runs.
/// - Frames differ or are not joined; a tag's place on its body is not given.
/// - There is no pose at all.
pub fn read_bag<R: Read>(
    files: impl IntoIterator<Item = (String, R)>,
    options: &BagOptions,
) -> Result<(Log, Vec<LogWarning>), McapError> {
    // the messages, up to where files are damaged, and whether all topics are there
    let mut recording = Recording::default();
    let mut names = Vec::new();
    for (name, file) in files {
        names.push(name);
        let added = recording.add(file, options);
        added.map_err(|problem| whole(&names, problem))?;
    }
    let reader = Reader {
        files: &names,
        options,
        recording: &recording,
    };
    let mut warnings = damage_warnings(&recording, &names);
    warnings.extend(unread(&recording, &names, &options.topics));
    let (others, sensors) = reader
        .check_topics()
        .map_err(|problem| reader.whole(problem))?;

    // poses and touches make the rows
    let mut frame = CommonFrame::default();
    let mut transforms = BTreeMap::new();
    let mut poses = |topic| reader.poses(topic, (&mut frame, &mut transforms), &mut warnings);
    let (object, covariances) = poses(Topic::Object)?;
    let fingers = once(Topic::Pusher).chain((1..=others).map(Topic::Finger));
    let fingers = fingers.map(|finger| Ok(poses(finger)?.0));
    let fingers: Vec<Series<Pose>> = fingers.collect::<Result<_, McapError>>()?;
    let touches = reader.touches(sensors, (&object, &fingers), &mut warnings)?;
    let mut rows = Rows::new(&object, &fingers, &touches);
    let time = reader
        .times(&rows)
        .map_err(|problem| reader.whole(problem))?;

    // forces fill cells in them
    let force = reader.forces(&rows, &mut frame, &mut warnings)?;
    let log = Log {
        time,
        object_covariance: own_covariances(&rows, &covariances),
        object: rows.object,
        other_fingers: rows.fingers.split_off(1),
        pusher: rows.fingers.swap_remove(0),
        tactile: rows.tactile,
        force,
    };
    Ok((log, warnings))
}

impl Wanted for BagOptions {
    fn wants(&self, name: &str, _: &str) -> bool {
        self.topics.wants(name)
    }

    fn takes(&self, name: &str, log_time: u64) -> bool {
        self.part.has(log_time) || name.ends_with("_static")
    }
}

/// The warning about topics that carry poses, forces or touches and are not read. Transforms are
/// in most bags, and are of other things.
fn unread(recording: &Recording, files: &[String], topics: &Topics) -> Option<LogWarning> {
    let left = topics.left_out();
    let readable = recording.names.iter().filter(|(name, seen)| {
        let is_measured = PoseKind::of(&seen.schema).is_some()
            || [WrenchStamped::TYPE, Bool::TYPE].contains(&seen.schema.as_str());
        is_measured && seen.count > 0 && !topics.wants(name) && !left.contains(name)
    });
    let (mut names, mut messages) = (Vec::new(), 0);
    for (name, seen) in readable {
        names.push(name.clone());
        messages += seen.count;
    }
    (!names.is_empty()).then(|| LogWarning::Unread {
        file: files.first().cloned().unwrap_or_default(),
        topics: names,
        messages,
    })
}

/// Covariances of the object's poses row by row; empty where no message has one.
fn own_covariances(
    rows: &Rows,
    told: &BTreeMap<i64, PoseCovariance>,
) -> Vec<Option<PoseCovariance>> {
    if told.is_empty() {
        return Vec::new();
    }
    let seen = rows.time.iter().zip(&rows.object);
    seen.map(|(time, pose)| pose.and_then(|_| told.get(time).copied()))
        .collect()
}

/// An error of the whole bag, reported for its latest file.
pub(crate) fn whole(files: &[String], problem: McapProblem) -> McapError {
    McapError {
        file: files.last().cloned().unwrap_or_default(),
        place: None,
        problem: Box::new(problem),
    }
}

/// The warnings about where files end too early.
pub(crate) fn damage_warnings(recording: &Recording, files: &[String]) -> Vec<LogWarning> {
    let warning = |damage: &Damage| LogWarning::CutOff {
        file: files[damage.file].clone(),
        at: damage.at,
        size: damage.size,
        why: damage.why.clone(),
    };
    recording.damage.iter().map(warning).collect()
}

/// A bag with the names of its files and how it is read.
pub(crate) struct Reader<'a> {
    pub files: &'a [String],
    pub options: &'a BagOptions,
    pub recording: &'a Recording,
}

/// Transforms by the topic that they are on.
type ByTopic<'a> = BTreeMap<String, Transforms<'a>>;

impl<'a> Reader<'a> {
    /// An error of the whole bag.
    pub(crate) fn whole(&self, problem: McapProblem) -> McapError {
        whole(&self.files[..self.files.len().min(1)], problem)
    }

    /// All needed topics are there; the numbers of other fingers and of sensors.
    fn check_topics(&self) -> Result<(usize, usize), McapProblem> {
        self.require(Topic::Object)?;
        self.require(Topic::Pusher)?;
        Ok((self.numbered(Topic::Finger)?, self.sensors()?))
    }

    /// Refuses a bag that lacks a topic.
    pub(crate) fn require(&self, topic: Topic) -> Result<(), McapProblem> {
        for place in self.options.topics.places(topic) {
            if !self.recording.topics.contains_key(&place.topic) {
                return Err(self.missing(topic, place.topic));
            }
        }
        Ok(())
    }

    fn missing(&self, topic: Topic, name: String) -> McapProblem {
        let found = &self.recording.names;
        let damage = self.recording.damage.first();
        if let Some(damage) = damage.filter(|_| found.is_empty()) {
            return McapProblem::Unreadable {
                why: damage.why.clone(),
            };
        }
        let free = found
            .keys()
            .map(String::as_str)
            .filter(|name| self.options.topics.carries(name).is_none());
        let hint = nearest(&name, free).filter(|(_, distance)| *distance <= name.len() / 2);
        let hint = hint.map_or(String::new(), |(nearest, _)| {
            format!(", the nearest is `{nearest}`")
        });
        let damage = damage
            .map(|damage| format!(", and the recording is cut off after {} bytes", damage.at));
        let hint = hint + &damage.unwrap_or_default();
        McapProblem::MissingTopic {
            topic,
            name,
            hint,
            found: found.keys().cloned().collect(),
        }
    }

    pub(crate) fn name(&self, topic: Topic) -> String {
        self.options.topics.name(topic).unwrap_or_default()
    }

    /// A topic that is read as a whole, if it is there.
    pub(crate) fn source(&self, topic: Topic) -> Option<Source<'a>> {
        let place = self.options.topics.places(topic).into_iter().next()?;
        self.source_of(&place.topic)
    }

    fn source_of(&self, name: &str) -> Option<Source<'a>> {
        let (name, content) = self.recording.topics.get_key_value(name)?;
        Some(Source {
            files: self.files,
            name,
            content,
        })
    }

    /// The poses of a body, from all of its places.
    fn poses(
        &self,
        topic: Topic,
        (frame, transforms): (&mut CommonFrame, &mut ByTopic<'a>),
        warnings: &mut Vec<LogWarning>,
    ) -> Result<(Series<Pose>, BTreeMap<i64, PoseCovariance>), McapError> {
        let places = self.options.topics.places(topic);
        let (mounts, none) = (&self.options.mounts, BTreeMap::new());
        let body = TaggedBody {
            body: topic,
            mounts: match topic {
                Topic::Object => &mounts.object,
                Topic::Pusher => &mounts.pusher,
                _ => &none,
            },
            frames: places.len(),
        };
        let (mut all, mut covariances) = (Vec::new(), BTreeMap::new());
        for place in &places {
            let Some(source) = self.source_of(&place.topic) else {
                continue;
            };
            let read = match &place.frames {
                None => BodyPoses::of_topic(&source, frame)?,
                Some(frames) => {
                    let checked = frame.check(&frames.parent, &place.topic, false);
                    checked.map_err(|problem| source.error(None, problem))?;
                    let known = self.transforms(transforms, place, source)?;
                    BodyPoses::of_frames(&source, known, frames, &body)?
                }
            };
            warnings.extend(self.pose_warnings(place, &read));
            // of several places, none has a covariance
            covariances = read.covariances;
            all.push(read.poses);
        }
        Ok((joined(all), covariances))
    }

    /// The transforms of a topic, read once.
    fn transforms<'t>(
        &self,
        known: &'t mut ByTopic<'a>,
        place: &Place,
        source: Source<'a>,
    ) -> Result<&'t Transforms<'a>, McapError> {
        if !known.contains_key(&place.topic) {
            let fixed = place.static_topic().and_then(|name| self.source_of(&name));
            known.insert(place.topic.clone(), Transforms::read(source, fixed)?);
        }
        Ok(&known[&place.topic])
    }

    /// The warnings about the poses at a place.
    fn pose_warnings(&self, place: &Place, read: &BodyPoses) -> Vec<LogWarning> {
        let file = || self.files.first().cloned().unwrap_or_default();
        let Tilt { count, largest } = read.tilt;
        let tilted = (count > 0).then(|| LogWarning::Tilted {
            file: file(),
            topic: place.to_string(),
            count,
            of: read.poses.len(),
            largest,
        });
        let impossible = (read.impossible > 0).then(|| LogWarning::NoCovariance {
            file: file(),
            topic: place.to_string(),
            count: read.impossible,
            of: read.poses.len(),
        });
        let warnings = [tilted, impossible].into_iter().flatten();
        let losses = read
            .losses
            .warnings(&place.to_string(), &file(), read.poses.len());
        warnings.chain(losses).collect()
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
}
