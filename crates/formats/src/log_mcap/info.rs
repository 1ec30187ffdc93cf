//! Content of a bag, and the parts of it that a log could be read from: [`read_bag_info`].

use std::io::Read;

use serde::Serialize;
use stickslip_dynamics::Pose;

use crate::left_out::LeftOut;
use crate::log_mcap::error::McapError;
use crate::log_mcap::image_message::{IMAGE_TYPES, INFO_TYPE};
use crate::log_mcap::losses::Losses;
use crate::log_mcap::message::{Bool, Message, SECOND, WrenchStamped};
use crate::log_mcap::place::{Frames, Place};
use crate::log_mcap::planar::{ZAxis, planar};
use crate::log_mcap::pose_message::{PoseKind, TfMessage};
use crate::log_mcap::read::{damage_warnings, whole};
use crate::log_mcap::recording::{Recording, Seen, Wanted};
use crate::log_mcap::series::{Series, Timed};
use crate::log_mcap::source::{CommonFrame, Source};
use crate::log_mcap::suggestion;
use crate::log_mcap::transforms::Transforms;
use crate::log_warning::LogWarning;

/// Most frames of transforms in which poses are sought.
const MOST_PARENTS: usize = 12;

/// Content of a bag.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BagInfo {
    /// Its topics by name.
    pub topics: Vec<TopicInfo>,
    /// Motions, by topic and by frame.
    pub poses: Vec<PosesInfo>,
    /// Topics that would do for a log, as `--topic` takes them; keys are left out where nothing
    /// would.
    pub suggestion: Vec<String>,
    /// Topics that would do to find the poses in images, as `stickslip track --topic` takes them;
    /// empty without images.
    pub image_suggestion: Vec<String>,
    /// Poses that are no measurements, or repeated, by place.
    pub left_out: Vec<LeftOut>,
}

/// A topic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TopicInfo {
    /// Its name.
    pub name: String,
    /// Its message type.
    pub message_type: String,
    /// Its messages.
    pub messages: usize,
    /// Their mean rate by log time (1/s).
    pub rate: Option<f64>,
    /// Longest time between two of them (s).
    pub longest_gap: f64,
    /// Keys that it could be read for.
    pub keys: Vec<&'static str>,
}

/// The poses of something that moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PosesInfo {
    /// Topic, and frames where it carries transforms; as `--topic` takes it.
    pub place: String,
    /// Poses.
    pub poses: usize,
    /// Their mean rate by stamp (1/s).
    pub rate: Option<f64>,
    /// Longest time between two of them (s).
    pub longest_gap: f64,
    /// Largest distance from its first position (m).
    pub moves: f64,
    /// Time at which it has gone a tenth of that (s after the bag's first pose).
    pub moves_at: f64,
    /// Largest angle between its z-axis and the vertical of the frame it is in (deg).
    pub tilt_deg: f64,
    /// Reason why it cannot be read; `None` where it can.
    pub problem: Option<String>,
}

/// All poses.
struct Poses;

impl Wanted for Poses {
    fn wants(&self, _: &str, schema: &str) -> bool {
        PoseKind::of(schema).is_some() || schema == TfMessage::TYPE
    }
}

/// Looks through the MCAP files of a bag, each with the name to show in errors and warnings.
///
/// # Errors
/// The bytes are no MCAP file or cannot be read.
pub fn read_bag_info<R: Read>(
    files: impl IntoIterator<Item = (String, R)>,
) -> Result<(BagInfo, Vec<LogWarning>), McapError> {
    let mut recording = Recording::default();
    let mut names = Vec::new();
    for (name, file) in files {
        names.push(name);
        let added = recording.add(file, &Poses);
        added.map_err(|problem| whole(&names, problem))?;
    }
    let topics: Vec<TopicInfo> = recording.names.iter().map(topic).collect();
    let mut moving: Vec<(Place, Motion)> = Vec::new();
    for (name, content) in &recording.topics {
        let source = Source {
            files: &names,
            name,
            content,
        };
        let schema = content
            .kinds
            .first()
            .map_or("", |kind| kind.schema.as_str());
        if PoseKind::of(schema).is_some() {
            let read = source.poses(&mut CommonFrame::default());
            let motion = read.map(|found| SeenPoses {
                poses: found.poses,
                tilt: found.tilt.largest,
                losses: found.losses,
            });
            moving.push((
                Place::topic(name.clone()),
                motion.map_err(|error| error.problem.to_string()),
            ));
        } else if schema == TfMessage::TYPE && !name.ends_with("_static") {
            let fixed = recording.topics.get_key_value(&format!("{name}_static"));
            let fixed = fixed.map(|(name, content)| Source {
                files: &names,
                name,
                content,
            });
            if let Ok(transforms) = Transforms::read(source, fixed) {
                moving.extend(frames(name, &transforms));
            }
        }
    }
    let start = moving
        .iter()
        .filter_map(|(_, motion)| Some(motion.as_ref().ok()?.poses.first()?.time))
        .min();
    let mut warnings = damage_warnings(&recording, &names);
    let file = names.first().cloned().unwrap_or_default();
    for (place, motion) in &moving {
        let of_motion = motion.as_ref().map(|seen| {
            let kept = seen.poses.len();
            seen.losses.warnings(&place.to_string(), &file, kept)
        });
        warnings.extend(of_motion.unwrap_or_default());
    }
    let left_out = warnings.iter().filter_map(LogWarning::left_out);
    let left_out = left_out.cloned().collect();
    let poses: Vec<PosesInfo> = moving
        .into_iter()
        .map(|(place, motion)| poses_info(&place, motion, start.unwrap_or(0)))
        .collect();
    let suggestion = suggestion::suggestion(&topics, &poses);
    let info = BagInfo {
        image_suggestion: suggestion::images(&topics),
        topics,
        poses,
        suggestion,
        left_out,
    };
    Ok((info, warnings))
}

/// Poses of something that moves.
struct SeenPoses {
    poses: Series<Pose>,
    /// Largest tilt (rad).
    tilt: f64,
    losses: Losses,
}

/// Poses, or why there are none.
type Motion = Result<SeenPoses, String>;

fn topic((name, seen): (&String, &Seen)) -> TopicInfo {
    let keys = match seen.schema.as_str() {
        schema if PoseKind::of(schema).is_some() => &["object", "pusher"][..],
        TfMessage::TYPE if !name.ends_with("_static") => &["object", "pusher"],
        WrenchStamped::TYPE => &["wrench", "fixel"],
        Bool::TYPE => &["fixel"],
        schema if IMAGE_TYPES.contains(&schema) => &["image"],
        INFO_TYPE => &["info"],
        _ => &[],
    };
    TopicInfo {
        name: name.clone(),
        message_type: seen.schema.clone(),
        messages: seen.count,
        rate: rate(seen.count, seen.last.abs_diff(seen.first)),
        longest_gap: seen.longest_gap as f64 / SECOND as f64,
        keys: keys.to_vec(),
    }
}

/// Mean rate (1/s) of events over a time (ns).
fn rate(count: usize, over: u64) -> Option<f64> {
    (count > 1 && over > 0).then(|| (count - 1) as f64 * SECOND as f64 / over as f64)
}

/// Frames of a topic that move, in the frame in which most of them stay upright.
fn frames(topic: &str, transforms: &Transforms<'_>) -> Vec<(Place, Motion)> {
    let all = transforms.frames();
    let moving = transforms.moving();
    // names that a table may have come first, then the frames that nothing is above
    let mut parents: Vec<&str> = all
        .iter()
        .copied()
        .filter(|frame| !moving.contains(frame))
        .collect();
    parents.sort_by_key(|frame| (!suggestion::is_table(frame), transforms.depth(frame)));
    let of = |parent: &str| -> Vec<(Place, Motion)> {
        let children = moving.iter().filter(|child| **child != parent);
        let motions = children.filter_map(|child| {
            let frames = Frames {
                parent: parent.to_owned(),
                child: (*child).to_owned(),
            };
            let motion = upright(transforms, &frames)?;
            let place = Place {
                topic: topic.to_owned(),
                frames: Some(frames),
            };
            Some((place, motion))
        });
        motions.collect()
    };
    let mut best: Vec<(Place, Motion)> = Vec::new();
    for parent in parents.into_iter().take(MOST_PARENTS) {
        let found = of(parent);
        let flat = |motions: &[(Place, Motion)]| {
            motions.iter().filter(|(_, motion)| motion.is_ok()).count()
        };
        if best.is_empty() || flat(&found) > flat(&best) {
            best = found;
        }
    }
    best
}

/// The poses between two frames that are joined; in space they have none in the plane.
fn upright(transforms: &Transforms<'_>, frames: &Frames) -> Option<Motion> {
    /// Tilt from which a frame is not that of something on the table (rad).
    const ASKEW: f64 = 0.35;
    let chain = match transforms.chain(frames) {
        Ok(chain) => chain,
        Err(error) if error.is_about_frames() => return None,
        Err(error) => return Some(Err(error.problem.to_string())),
    };
    let mut largest = 0.0;
    let mut poses = Vec::with_capacity(chain.poses.len());
    for Timed { time, value } in chain.poses {
        match planar(&value.0, &value.1, ZAxis::UpOrDown) {
            Ok((value, tilt)) => {
                largest = if tilt > largest { tilt } else { largest };
                poses.push(Timed { time, value });
            }
            Err(problem) => return Some(Err(problem.to_string())),
        }
    }
    if largest > ASKEW {
        return Some(Err(format!(
            "tilted by {:.0} deg in `{}`: no frame of the table leads here",
            largest.to_degrees(),
            frames.parent
        )));
    }
    Some(Ok(SeenPoses {
        poses,
        tilt: largest,
        losses: chain.losses,
    }))
}

fn poses_info(place: &Place, motion: Motion, start: i64) -> PosesInfo {
    let mut info = PosesInfo {
        place: place.to_string(),
        poses: 0,
        rate: None,
        longest_gap: 0.0,
        moves: 0.0,
        moves_at: 0.0,
        tilt_deg: 0.0,
        problem: None,
    };
    let SeenPoses { poses, tilt, .. } = match motion {
        Ok(motion) => motion,
        Err(problem) => {
            info.problem = Some(problem);
            return info;
        }
    };
    let (Some(first), Some(last)) = (poses.first(), poses.last()) else {
        return info;
    };
    let from_first = |pose: &Timed<Pose>| {
        libm::hypot(pose.value.x - first.value.x, pose.value.y - first.value.y)
    };
    let farther = |most: f64, far: f64| if far > most { far } else { most };
    info.poses = poses.len();
    info.rate = rate(poses.len(), last.time.abs_diff(first.time));
    let gaps = poses.array_windows().map(|[a, b]| b.time.abs_diff(a.time));
    info.longest_gap = gaps.max().unwrap_or(0) as f64 / SECOND as f64;
    info.moves = poses.iter().map(from_first).fold(0.0, farther);
    let gone = poses
        .iter()
        .find(|pose| from_first(pose) >= 0.1 * info.moves);
    info.moves_at = gone.map_or(0.0, |pose| {
        pose.time.saturating_sub(start) as f64 / SECOND as f64
    });
    info.tilt_deg = tilt.to_degrees();
    info
}
