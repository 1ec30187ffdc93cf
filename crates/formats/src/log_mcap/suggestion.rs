//! Topics of a bag that would do for a log, by their names and by the motion in them:
//! [`suggestion`].

use crate::log_mcap::camera_topics::{CameraMapping, CameraTopics};
use crate::log_mcap::info::{PosesInfo, TopicInfo};
use crate::log_mcap::topics::Topic;

/// Parts of names that objects have.
const OBJECT: [&str; 9] = [
    "object", "obj", "box", "block", "slider", "part", "body", "target", "tag",
];
/// Parts of names that pushers have.
const PUSHER: [&str; 14] = [
    "pusher",
    "finger",
    "fingertip",
    "tip",
    "tool",
    "tcp",
    "ee",
    "eef",
    "effector",
    "flange",
    "gripper",
    "hand",
    "probe",
    "rod",
];
/// Parts of names that touch sensors have.
const TOUCH: [&str; 6] = ["fixel", "contact", "touch", "tactile", "bumper", "taxel"];
/// Names of frames that a table may have.
const TABLE: [&str; 5] = ["table", "world", "map", "workspace", "base"];
/// Way below which nothing is pushed (m).
const STANDS: f64 = 1e-3;

/// Mappings as `--topic` takes them, without those that are named as by default.
pub(crate) fn suggestion(topics: &[TopicInfo], poses: &[PosesInfo]) -> Vec<String> {
    let mut moving: Vec<&PosesInfo> = poses.iter().filter(|poses| poses.moves > STANDS).collect();
    // of the same kind the one that was seen most often
    moving.sort_by_key(|info| std::cmp::Reverse(info.poses));
    let mut suggested = Vec::new();
    let object = body(&mut moving, Topic::Object, &OBJECT);
    let pusher = body(&mut moving, Topic::Pusher, &PUSHER);
    // what is left by its motion: the pusher moves first
    moving.sort_by(|a, b| a.moves_at.total_cmp(&b.moves_at));
    let pusher = pusher.or_else(|| (!moving.is_empty()).then(|| moving.remove(0).place.clone()));
    let object = object.or_else(|| (!moving.is_empty()).then(|| moving.remove(0).place.clone()));
    for (topic, place) in [(Topic::Object, object), (Topic::Pusher, pusher)] {
        let own = topic.default_name();
        suggested.extend(
            place
                .filter(|place| *place != own)
                .map(|place| format!("{topic}={place}")),
        );
    }
    suggested.extend(sensors(topics));
    suggested
}

/// Mappings of a bag with images: of several cameras the one whose numbers are there, and whose
/// images are as its lens made them; nothing without images.
pub(crate) fn images(topics: &[TopicInfo]) -> Vec<String> {
    let camera = |info: &TopicInfo| CameraTopics::new([CameraMapping::Image(info.name.clone())]);
    let with_images = topics.iter().filter(|info| info.keys.contains(&"image"));
    let cameras = with_images.filter_map(|info| Some((info, camera(info).ok()?)));
    let best = cameras.min_by_key(|(info, camera)| {
        let has_info = topics
            .iter()
            .any(|other| Some(other.name.as_str()) == camera.info());
        (
            !has_info,
            camera.is_rectified(),
            std::cmp::Reverse(info.messages),
        )
    });
    let Some((image, _)) = best else {
        return Vec::new();
    };
    let image = format!("image={}", image.name);
    [image].into_iter().chain(sensors(topics)).collect()
}

/// Returns true if a frame is named as that of a table.
pub(crate) fn is_table(frame: &str) -> bool {
    has_word(frame, &TABLE)
}

/// The place of a body: by its own name, else by a name of its kind; taken out of the others.
fn body(moving: &mut Vec<&PosesInfo>, topic: Topic, words: &[&str]) -> Option<String> {
    let own = topic.default_name();
    // of a transform, the child's name says what it is
    let said = |info: &&PosesInfo| match info.place.split_once(':') {
        Some((_, frames)) => has_word(
            frames.split_once('.').map_or(frames, |(_, child)| child),
            words,
        ),
        None => has_word(&info.place, words),
    };
    let found = moving.iter().position(|info| info.place == own);
    let found = found.or_else(|| moving.iter().position(said))?;
    Some(moving.remove(found).place.clone())
}

/// Touch sensors that are not named as by default, in the order of their names.
fn sensors(topics: &[TopicInfo]) -> Vec<String> {
    let is_sensor =
        |info: &&TopicInfo| info.keys.contains(&"fixel") && has_word(&info.name, &TOUCH);
    let mut names: Vec<&str> = topics
        .iter()
        .filter(is_sensor)
        .map(|info| info.name.as_str())
        .collect();
    // tip_10 comes after tip_9
    names.sort_by_key(|name| (name.len(), *name));
    let named = (1..).zip(names).map(|(k, name)| (Topic::Fixel(k), name));
    let others = named.filter(|(topic, name)| topic.default_name() != **name);
    others
        .map(|(topic, name)| format!("{topic}={name}"))
        .collect()
}

/// Returns true if one of the words is a part of the name. Parts end at other characters than
/// letters, and where a small letter meets a capital one.
fn has_word(name: &str, words: &[&str]) -> bool {
    let mut parts = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        if !c.is_alphabetic() || (before.is_lowercase() && c.is_uppercase()) {
            parts.push(String::new());
        }
        if c.is_alphabetic() {
            parts
                .last_mut()
                .into_iter()
                .for_each(|part| part.extend(c.to_lowercase()));
        }
        before = c;
    }
    parts.iter().any(|part| words.contains(&part.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poses(place: &str, moves: f64, moves_at: f64) -> PosesInfo {
        PosesInfo {
            place: place.to_owned(),
            poses: 100,
            rate: Some(30.0),
            longest_gap: 0.1,
            moves,
            moves_at,
            tilt_deg: 0.0,
            problem: None,
        }
    }

    #[test]
    fn names_say_what_is_what_and_motion_where_they_do_not() {
        let touch = |name: &str| TopicInfo {
            name: name.to_owned(),
            message_type: String::new(),
            messages: 1,
            rate: None,
            longest_gap: 0.0,
            keys: vec!["fixel"],
        };
        let tf = [
            poses("/tf:table.tag36h11:7", 0.1, 2.0),
            poses("/tf:table.tool0", 0.2, 1.0),
            poses("/tf:table.tag36h11:9", 0.0, 0.0),
        ];
        let touches = [
            touch("/left/contact_10"),
            touch("/left/contact_9"),
            touch("/estop"),
        ];
        assert_eq!(
            suggestion(&touches, &tf),
            [
                "object=/tf:table.tag36h11:7",
                "pusher=/tf:table.tool0",
                "fixel_1=/left/contact_9",
                "fixel_2=/left/contact_10"
            ]
        );
        let unnamed = [poses("/a", 0.1, 2.0), poses("/b", 0.1, 1.0)];
        assert_eq!(suggestion(&[], &unnamed), ["object=/a", "pusher=/b"]);
        let own = [
            poses("/object/pose", 0.1, 1.0),
            poses("/pusher/pose", 0.1, 1.0),
        ];
        assert_eq!(
            suggestion(&[touch("/fixel_1/contact")], &own),
            Vec::<String>::new()
        );
    }

    #[test]
    fn words_are_whole_parts_of_names() {
        for (name, found) in [
            ("/ee_pose", true),
            ("/feed", false),
            ("/panda/EePose", true),
            ("tool0", true),
        ] {
            assert_eq!(has_word(name, &PUSHER), found, "{name}");
        }
    }
}
