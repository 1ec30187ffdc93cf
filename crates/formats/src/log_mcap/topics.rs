//! Topics and the quantities that they carry: [`Topic`], [`TopicMapping`], [`Topics`].

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use crate::log_mcap::place::Place;
use crate::nearest::nearest;

/// Quantity that a topic carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Poses of the object.
    Object,
    /// Poses of the pusher.
    Pusher,
    /// Poses of the k-th other finger of a hand, counted from 1.
    Finger(usize),
    /// Forces of the pusher on the object.
    Wrench,
    /// Readings of the k-th tactile sensor, counted from 1: those of fixels, then those of a hand's
    /// fingers.
    Fixel(usize),
}

/// A topic under another name than its own; as text `object=/vicon/box/pose`, or
/// `object=/tf:table.tag_7` for a frame among transforms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicMapping {
    /// Quantity that it carries.
    pub topic: Topic,
    /// Its place in the recording; `None` for a wrench that is not to be read or written.
    pub place: Option<Place>,
}

/// Places of all topics: `/object/pose`, `/pusher/pose`, `/finger_<k>/pose`, `/pusher/wrench`,
/// `/fixel_<k>/contact`, or those that they are mapped to. A body may have several frames.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics(BTreeMap<Topic, Vec<Place>>);

/// Reason why a mapping was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopicError {
    /// There is no `=` in it.
    #[error("`{0}` has no `=`; write KEY=TOPIC, as object=/vicon/box/pose")]
    NoTopic(String),
    /// The key is none.
    #[error(
        "`{found}` is none of the keys object, pusher, finger_1, ..., wrench, fixel_1, fixel_2, ...; the nearest is {nearest}"
    )]
    UnknownKey {
        /// The key.
        found: String,
        /// A key that is one.
        nearest: String,
    },
    /// The text after a colon is not two frames.
    #[error("`{0}` does not name two frames; write TOPIC:PARENT.CHILD, as /tf:table.tag_7")]
    NoFrames(String),
    /// Frames where none can be.
    #[error(
        "{0} has no frames; only object, pusher and fingers are read from transforms. Give a topic without `:`"
    )]
    Frameless(Topic),
    /// No name for a topic that must be there.
    #[error("{0} has no name; only the wrench can be left out. Write the topic after the `=`")]
    Nameless(Topic),
    /// One key, two names.
    #[error(
        "{topic} is mapped to `{first}` and to `{second}`; map it once, or to different frames of transforms"
    )]
    Twice {
        /// The key.
        topic: Topic,
        /// The first name.
        first: String,
        /// The second one.
        second: String,
    },
    /// A key that a bag of images does not have.
    #[error(
        "`{found}` is none of the keys image, info, wrench, fixel_1, fixel_2, ...; the nearest is {nearest}"
    )]
    UnknownCameraKey {
        /// The key.
        found: String,
        /// A key that is one.
        nearest: String,
    },
    /// Poses that are not read but found.
    #[error(
        "{0} is found in the images by its tag. Leave the mapping out, or filter the bag itself where it has poses"
    )]
    InImages(String),
    /// Nothing to look at.
    #[error(
        "no topic of images is named. Write image=/camera/image_raw; `stickslip info` lists the topics of a bag"
    )]
    NoImages,
    /// A camera's key, two names.
    #[error("{key} is mapped to `{first}` and to `{second}`; map it once")]
    CameraTwice {
        /// The key.
        key: &'static str,
        /// The first name.
        first: String,
        /// The second one.
        second: String,
    },
    /// Two keys, one name.
    #[error("{first} and {second} are both mapped to `{name}`; a topic carries one thing")]
    Shared {
        /// The first key.
        first: Topic,
        /// The second one.
        second: Topic,
        /// The name.
        name: String,
    },
}

impl Topic {
    /// The name without a mapping.
    #[must_use]
    pub fn default_name(self) -> String {
        match self {
            Self::Object => "/object/pose".to_owned(),
            Self::Pusher => "/pusher/pose".to_owned(),
            Self::Finger(k) => format!("/finger_{k}/pose"),
            Self::Wrench => "/pusher/wrench".to_owned(),
            Self::Fixel(k) => format!("/fixel_{k}/contact"),
        }
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Object => f.write_str("object"),
            Self::Pusher => f.write_str("pusher"),
            Self::Finger(k) => write!(f, "finger_{k}"),
            Self::Wrench => f.write_str("wrench"),
            Self::Fixel(k) => write!(f, "fixel_{k}"),
        }
    }
}

impl FromStr for Topic {
    type Err = TopicError;

    fn from_str(key: &str) -> Result<Self, TopicError> {
        match key {
            "object" => Ok(Self::Object),
            "pusher" => Ok(Self::Pusher),
            "wrench" => Ok(Self::Wrench),
            _ => numbered(key, ["fixel_", ""], ["finger_", ""]).ok_or_else(|| unknown(key)),
        }
    }
}

fn unknown(key: &str) -> TopicError {
    let closest = nearest(key, ["object", "pusher", "wrench", "fixel_1", "finger_1"])
        .map_or("object", |(name, _)| name);
    TopicError::UnknownKey {
        found: key.to_owned(),
        nearest: closest.to_owned(),
    }
}

/// The numbered topic whose number is between these texts, of a fixel or of a finger.
fn numbered(text: &str, fixel: [&str; 2], finger: [&str; 2]) -> Option<Topic> {
    let fixel = number_between(text, fixel).map(Topic::Fixel);
    fixel.or_else(|| number_between(text, finger).map(Topic::Finger))
}

/// The number between `before` and `after`, from 1 up and as it is written out.
fn number_between(text: &str, [before, after]: [&str; 2]) -> Option<usize> {
    let digits = text.strip_prefix(before)?.strip_suffix(after)?;
    digits
        .parse()
        .ok()
        .filter(|k: &usize| *k > 0 && k.to_string() == digits)
}

impl FromStr for TopicMapping {
    type Err = TopicError;

    fn from_str(text: &str) -> Result<Self, TopicError> {
        let (key, name) = text
            .split_once('=')
            .ok_or_else(|| TopicError::NoTopic(text.to_owned()))?;
        let topic: Topic = key.parse()?;
        if name.is_empty() {
            return match topic {
                Topic::Wrench => Ok(Self { topic, place: None }),
                _ => Err(TopicError::Nameless(topic)),
            };
        }
        let place: Place = name.parse()?;
        if place.frames.is_some() && matches!(topic, Topic::Wrench | Topic::Fixel(_)) {
            return Err(TopicError::Frameless(topic));
        }
        Ok(Self {
            topic,
            place: Some(place),
        })
    }
}

impl Topics {
    /// All topics under their own names but for those that are mapped.
    ///
    /// # Errors
    /// A topic is mapped twice, but for several frames of one body, or two to one place.
    ///
    /// ```
    /// use stickslip_formats::{Topic, Topics};
    /// let topics = Topics::new(["object=/vicon/box/pose".parse()?])?;
    /// assert_eq!(topics.name(Topic::Object).as_deref(), Some("/vicon/box/pose"));
    /// assert_eq!(topics.name(Topic::Fixel(2)).as_deref(), Some("/fixel_2/contact"));
    /// # Ok::<(), stickslip_formats::TopicError>(())
    /// ```
    pub fn new(mappings: impl IntoIterator<Item = TopicMapping>) -> Result<Self, TopicError> {
        let mut places: BTreeMap<Topic, Vec<Place>> = BTreeMap::new();
        for TopicMapping { topic, place } in mappings {
            if let Some(place) = &place {
                refuse_shared(&places, topic, place)?;
            }
            let (mapped, own) = (
                places.contains_key(&topic),
                places.entry(topic).or_default(),
            );
            let is_frame = |place: &Place| place.frames.is_some();
            let joins = place.as_ref().is_some_and(|place| {
                own.iter().chain([place]).all(is_frame) && !own.contains(place)
            });
            if mapped && !joins {
                let shown = |place: Option<&Place>| place.map_or(String::new(), Place::to_string);
                return Err(TopicError::Twice {
                    topic,
                    first: shown(own.first()),
                    second: shown(place.as_ref()),
                });
            }
            own.extend(place);
        }
        Ok(Self(places))
    }

    /// Name of a topic, with its first frames where it has some; `None` for a wrench that is left
    /// out.
    #[must_use]
    pub fn name(&self, topic: Topic) -> Option<String> {
        self.places(topic).first().map(Place::to_string)
    }

    /// Places of a topic; none if it is left out.
    pub(crate) fn places(&self, topic: Topic) -> Vec<Place> {
        let own = || vec![Place::topic(topic.default_name())];
        self.0.get(&topic).cloned().unwrap_or_else(own)
    }

    /// Names of topics that are left out on purpose.
    pub(crate) fn left_out(&self) -> Vec<String> {
        let empty = self.0.iter().filter(|(_, places)| places.is_empty());
        empty.map(|(topic, _)| topic.default_name()).collect()
    }

    /// Returns true if nothing is mapped.
    #[must_use]
    pub fn is_default(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns true if the topic is mapped to a name, and so must be there.
    pub(crate) fn is_mapped(&self, topic: Topic) -> bool {
        self.0.get(&topic).is_some_and(|places| !places.is_empty())
    }

    /// Returns true if a topic of a recording is needed.
    pub(crate) fn wants(&self, name: &str) -> bool {
        let mut mapped = self.0.values().flatten();
        let is_here =
            |place: &Place| place.topic == name || place.static_topic().as_deref() == Some(name);
        mapped.any(is_here) || self.carries(name).is_some()
    }

    /// Quantity that a topic of a recording carries, if any. A name that something is mapped to
    /// carries that and no other; one with frames carries nothing by itself.
    pub(crate) fn carries(&self, name: &str) -> Option<Topic> {
        let at = |(topic, place): (&Topic, &Place)| {
            (place.topic == name).then_some(Some(*topic).filter(|_| place.frames.is_none()))
        };
        let mapped = self
            .0
            .iter()
            .flat_map(|(topic, places)| places.iter().map(move |place| (topic, place)));
        if let Some(topic) = mapped.filter_map(at).next() {
            return topic;
        }
        let numbered = numbered(name, ["/fixel_", "/contact"], ["/finger_", "/pose"]);
        let known = [Topic::Object, Topic::Pusher, Topic::Wrench]
            .into_iter()
            .chain(numbered);
        known
            .into_iter()
            .find(|topic| topic.default_name() == name && !self.0.contains_key(topic))
    }

    /// Topics that are mapped, or left out.
    pub(crate) fn mapped(&self) -> impl Iterator<Item = Topic> {
        self.0.keys().copied()
    }
}

/// Refuses a place that another key has, and a topic read as a whole and by frames.
fn refuse_shared(
    places: &BTreeMap<Topic, Vec<Place>>,
    topic: Topic,
    place: &Place,
) -> Result<(), TopicError> {
    let clashes = |other: &Place| {
        let either_whole = other.frames.is_none() || place.frames.is_none();
        other.topic == place.topic && (either_whole || other.frames == place.frames)
    };
    let mut others = places.iter().filter(|(other, _)| **other != topic);
    match others.find(|(_, taken)| taken.iter().any(clashes)) {
        Some((first, _)) => Err(TopicError::Shared {
            first: *first,
            second: topic,
            name: place.to_string(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topics(mappings: &[&str]) -> Result<Topics, TopicError> {
        Topics::new(
            mappings
                .iter()
                .map(|text| text.parse())
                .collect::<Result<Vec<_>, _>>()?,
        )
    }

    #[test]
    fn carries_goes_by_mapping_then_by_own_name() {
        let topics = topics(&[
            "fixel_1=/fixel_2/contact",
            "fixel_2=/fixel_1/contact",
            "object=/box",
            "wrench=",
        ])
        .unwrap();
        for (name, topic) in [
            ("/fixel_1/contact", Some(Topic::Fixel(2))),
            ("/fixel_2/contact", Some(Topic::Fixel(1))),
            ("/fixel_3/contact", Some(Topic::Fixel(3))),
            ("/fixel_03/contact", None),
            ("/fixel_0/contact", None),
            ("/box", Some(Topic::Object)),
            ("/object/pose", None),
            ("/pusher/pose", Some(Topic::Pusher)),
            ("/pusher/wrench", None),
            ("/tf", None),
        ] {
            assert_eq!(topics.carries(name), topic, "{name}");
        }
    }

    #[test]
    fn a_body_may_have_several_frames() {
        let topics = topics(&["object=/tf:table.tag_7", "object=/tf:table.tag36h11:8"]).unwrap();
        let places = topics.places(Topic::Object);
        assert_eq!(
            places.iter().map(Place::to_string).collect::<Vec<_>>(),
            ["/tf:table.tag_7", "/tf:table.tag36h11:8"]
        );
        assert_eq!(topics.carries("/tf"), None);
        for (name, wanted) in [("/tf", true), ("/tf_static", true), ("/object/pose", false)] {
            assert_eq!(topics.wants(name), wanted, "{name}");
        }
    }

    #[test]
    fn mappings_are_refused_with_words() {
        for (mappings, words) in [
            (&["object"][..], "`object` has no `=`; write KEY=TOPIC"),
            (
                &["objekt=/a"],
                "`objekt` is none of the keys object, pusher, finger_1, ..., wrench, fixel_1, fixel_2, ...; the nearest is object",
            ),
            (&["fixel_01=/a"], "the nearest is fixel_1"),
            (
                &["pusher="],
                "pusher has no name; only the wrench can be left out",
            ),
            (
                &["object=/a", "object=/b"],
                "object is mapped to `/a` and to `/b`; map it once",
            ),
            (
                &["object=/a", "pusher=/a"],
                "object and pusher are both mapped to `/a`",
            ),
            (
                &["object=/tf:table"],
                "`/tf:table` does not name two frames",
            ),
            (&["fixel_1=/tf:table.tip"], "fixel_1 has no frames"),
            (
                &["object=/tf:table.a", "pusher=/tf:table.a"],
                "object and pusher are both mapped to `/tf:table.a`",
            ),
            (
                &["object=/tf:table.a", "pusher=/tf"],
                "object and pusher are both mapped to `/tf`",
            ),
            (
                &["object=/tf:table.a", "object=/tf:table.a"],
                "object is mapped to `/tf:table.a` and to `/tf:table.a`",
            ),
            (
                &["wrench=", "wrench=/ft"],
                "wrench is mapped to `` and to `/ft`",
            ),
        ] {
            let message = topics(mappings).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
