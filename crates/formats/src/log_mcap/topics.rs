//! Which topic carries what: [`Topic`], [`TopicMapping`], [`Topics`].

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use crate::nearest::nearest;

/// What a topic carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Poses of the object.
    Object,
    /// Poses of the pusher.
    Pusher,
    /// Forces of the pusher on the object.
    Wrench,
    /// Readings of a tactile sensor, that on the k-th fixel, counted from 1.
    Fixel(usize),
}

/// A topic under another name than its own; as text `object=/vicon/box/pose`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicMapping {
    /// What it carries.
    pub topic: Topic,
    /// Its name in the recording; empty for a wrench that is not to be read or written.
    pub name: String,
}

/// The names of all topics: `/object/pose`, `/pusher/pose`, `/pusher/wrench`, `/fixel_<k>/contact`,
/// or what they are mapped to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics(BTreeMap<Topic, String>);

/// Why a mapping was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopicError {
    /// There is no `=` in it.
    #[error("`{0}` has no `=`; write KEY=TOPIC, as object=/vicon/box/pose")]
    NoTopic(String),
    /// The key is none.
    #[error(
        "`{found}` is none of the keys object, pusher, wrench, fixel_1, fixel_2, ...; the nearest is {nearest}"
    )]
    UnknownKey {
        /// The key.
        found: String,
        /// A key that is one.
        nearest: String,
    },
    /// No name for a topic that must be there.
    #[error("{0} has no name; only the wrench can be left out. Write the topic after the `=`")]
    Nameless(Topic),
    /// One key, two names.
    #[error("{topic} is mapped to `{first}` and to `{second}`; map it once")]
    Twice {
        /// The key.
        topic: Topic,
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
            _ => fixel_number(key, "fixel_", "")
                .map(Self::Fixel)
                .ok_or_else(|| unknown(key)),
        }
    }
}

fn unknown(key: &str) -> TopicError {
    let closest =
        nearest(key, ["object", "pusher", "wrench", "fixel_1"]).map_or("object", |(name, _)| name);
    TopicError::UnknownKey {
        found: key.to_owned(),
        nearest: closest.to_owned(),
    }
}

/// The number between `before` and `after`, from 1 up and as it is written out.
fn fixel_number(text: &str, before: &str, after: &str) -> Option<usize> {
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
        if name.is_empty() && topic != Topic::Wrench {
            return Err(TopicError::Nameless(topic));
        }
        Ok(Self {
            topic,
            name: name.to_owned(),
        })
    }
}

impl Topics {
    /// All topics under their own names but for those that are mapped.
    ///
    /// # Errors
    /// A topic is mapped twice, or two to one name.
    ///
    /// ```
    /// use stickslip_formats::{Topic, Topics};
    /// let topics = Topics::new(["object=/vicon/box/pose".parse()?])?;
    /// assert_eq!(topics.name(Topic::Object).as_deref(), Some("/vicon/box/pose"));
    /// assert_eq!(topics.name(Topic::Fixel(2)).as_deref(), Some("/fixel_2/contact"));
    /// # Ok::<(), stickslip_formats::TopicError>(())
    /// ```
    pub fn new(mappings: impl IntoIterator<Item = TopicMapping>) -> Result<Self, TopicError> {
        let mut names = BTreeMap::new();
        for TopicMapping { topic, name } in mappings {
            if let Some((first, _)) = names
                .iter()
                .find(|(other, taken)| **other != topic && **taken == name)
            {
                return Err(TopicError::Shared {
                    first: *first,
                    second: topic,
                    name,
                });
            }
            if let Some(first) = names.insert(topic, name.clone()) {
                return Err(TopicError::Twice {
                    topic,
                    first,
                    second: name,
                });
            }
        }
        Ok(Self(names))
    }

    /// Name of a topic; `None` for a wrench that is left out.
    #[must_use]
    pub fn name(&self, topic: Topic) -> Option<String> {
        self.0.get(&topic).cloned().map_or_else(
            || Some(topic.default_name()),
            |name| Some(name).filter(|name| !name.is_empty()),
        )
    }

    /// Whether nothing is mapped.
    #[must_use]
    pub fn is_default(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether the topic is mapped to a name, and so must be there.
    pub(crate) fn is_mapped(&self, topic: Topic) -> bool {
        self.0.get(&topic).is_some_and(|name| !name.is_empty())
    }

    /// What a topic of a recording carries, if anything. A name that something is mapped to carries
    /// that and no other.
    pub(crate) fn carries(&self, name: &str) -> Option<Topic> {
        if let Some((topic, _)) = self.0.iter().find(|(_, mapped)| *mapped == name) {
            return Some(*topic);
        }
        let fixel = fixel_number(name, "/fixel_", "/contact").map(Topic::Fixel);
        let known = [Topic::Object, Topic::Pusher, Topic::Wrench]
            .into_iter()
            .chain(fixel);
        known
            .into_iter()
            .find(|topic| topic.default_name() == name && !self.0.contains_key(topic))
    }

    /// Numbers of the fixels that are mapped.
    pub(crate) fn mapped_fixels(&self) -> impl Iterator<Item = usize> {
        self.0.keys().filter_map(|topic| {
            if let Topic::Fixel(k) = topic {
                Some(*k)
            } else {
                None
            }
        })
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
    fn mappings_are_refused_with_words() {
        for (mappings, words) in [
            (&["object"][..], "`object` has no `=`; write KEY=TOPIC"),
            (
                &["objekt=/a"],
                "`objekt` is none of the keys object, pusher, wrench, fixel_1, fixel_2, ...; the nearest is object",
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
        ] {
            let message = topics(mappings).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
