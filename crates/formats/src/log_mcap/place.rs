//! Place of a key's messages: [`Place`], a topic or two frames on one.

use std::fmt;
use std::str::FromStr;

use crate::log_mcap::source::frame_name;
use crate::log_mcap::topics::TopicError;

/// Two frames: the pose of `child` in `parent`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Frames {
    /// Frame that poses are given in.
    pub parent: String,
    /// Frame whose poses they are.
    pub child: String,
}

/// A topic, or two frames on a topic of transforms; as text `/vicon/box/pose` or
/// `/tf:table.tag_7`, as evo writes it. The parent ends at the first dot.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Name of the topic.
    pub topic: String,
    /// The frames, where it carries transforms.
    pub frames: Option<Frames>,
}

impl Place {
    /// A whole topic.
    pub(crate) fn topic(name: String) -> Self {
        Self {
            topic: name,
            frames: None,
        }
    }

    /// Name of the topic with the transforms that never change, where this one has those that do.
    pub(crate) fn static_topic(&self) -> Option<String> {
        let of = |_: &Frames| format!("{}_static", self.topic);
        self.frames.as_ref().map(of)
    }
}

impl fmt::Display for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.parent, self.child)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.topic)?;
        match &self.frames {
            Some(frames) => write!(f, ":{frames}"),
            None => Ok(()),
        }
    }
}

impl FromStr for Place {
    type Err = TopicError;

    fn from_str(text: &str) -> Result<Self, TopicError> {
        let Some((topic, frames)) = text.split_once(':') else {
            return Ok(Self::topic(text.to_owned()));
        };
        match frames.split_once('.') {
            Some((parent, child)) if ![topic, parent, child].contains(&"") => Ok(Self {
                topic: topic.to_owned(),
                frames: Some(Frames {
                    parent: frame_name(parent).to_owned(),
                    child: frame_name(child).to_owned(),
                }),
            }),
            _ => Err(TopicError::NoFrames(text.to_owned())),
        }
    }
}
