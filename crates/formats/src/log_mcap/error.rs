//! Reason why a recording was refused: [`McapError`].

use std::fmt;

use crate::log_mcap::part::LogTime;
use crate::log_mcap::topics::Topic;
use crate::log_warning::listed;
use crate::number;

/// A message of a recording, as a person finds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct McapPlace {
    /// Name of the topic.
    pub topic: String,
    /// Number of the message among those of the topic in the file, counted from 1, and its log time
    /// (ns); `None` where the whole topic is meant.
    pub message: Option<(usize, u64)>,
}

/// Reason why a recording was refused, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct McapError {
    /// Display name of the file.
    pub file: String,
    /// Topic and message; `None` where the whole file is meant.
    pub place: Option<McapPlace>,
    /// The problem.
    pub problem: Box<McapProblem>,
}

impl McapError {
    /// Returns true if it says that two frames are not joined by the recorded transforms.
    pub(crate) fn is_about_frames(&self) -> bool {
        matches!(
            *self.problem,
            McapProblem::NoChain { .. }
                | McapProblem::NothingMoves { .. }
                | McapProblem::TwoParents { .. }
        )
    }
}

impl fmt::Display for McapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file)?;
        if let Some(place) = &self.place {
            write!(f, "{}", place.topic)?;
            if let Some((number, time)) = place.message {
                write!(
                    f,
                    ", message {number} (log time {}.{:09} s)",
                    time / 1_000_000_000,
                    time % 1_000_000_000
                )?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", self.problem)
    }
}

/// Problem of a recording.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum McapProblem {
    /// The file does not begin as an MCAP file.
    #[error(
        "the file begins with the bytes {found}, an MCAP recording with 89 4D 43 41 50 30 0D 0A. Give a file of `ros2 bag record -s mcap`"
    )]
    NotMcap {
        /// The first bytes.
        found: String,
    },
    /// The file is damaged before anything could be read.
    #[error(
        "nothing could be read: {why}. Try `mcap recover` on the file, or give another recording"
    )]
    Unreadable {
        /// The damage.
        why: String,
    },
    /// A chunk is packed in a way that is not known.
    #[error(
        "a chunk is compressed with `{found}`; none, zstd and lz4 can be read. Rewrite the file with `mcap compress`"
    )]
    Compression {
        /// Name of the compression.
        found: String,
    },
    /// A recording that unpacks to far more than its size.
    #[error(
        "it unpacks to more than 512 MiB and 100 times its size, as no recording does. Give the recording itself, or cut the wanted part out of it with `mcap filter`"
    )]
    Unpacks,
    /// Messages that take far more memory than the recording is large.
    #[error(
        "the first {count} messages of the needed topics take {megabytes} MB, far more than the recording itself. Map other topics, or cut the wanted part out of it with `mcap filter`"
    )]
    Memory {
        /// Their number.
        count: usize,
        /// Their memory (MB).
        megabytes: usize,
    },
    /// A topic that must be there is not.
    #[error(
        "the topic `{name}` ({topic}) is not there{hint}. Say which topic it is with {topic}=TOPIC; the recording has {}",
        if .found.is_empty() { "none".to_owned() } else { listed(.found) }
    )]
    MissingTopic {
        /// Quantity that it carries.
        topic: Topic,
        /// Its name.
        name: String,
        /// The nearest topic and where the recording is damaged, each behind a comma, or empty.
        hint: String,
        /// All topics of the recording.
        found: Vec<String>,
    },
    /// A camera's topic that must be there is not.
    #[error(
        "the topic `{name}` ({key}) is not there. Say which topic it is with {key}=TOPIC; {}",
        if .found.is_empty() { "the recording has none of its type".to_owned() } else { format!("of its type the recording has {}", listed(.found)) }
    )]
    NoCameraTopic {
        /// Its key.
        key: &'static str,
        /// Its name.
        name: String,
        /// Topics that could be meant.
        found: Vec<String>,
    },
    /// A camera whose numbers change during the recording.
    #[error(
        "CameraInfo changes from a focal length of {before} px to {now} px; a camera must stay as it is. Switch autofocus and zoom off, or leave CameraInfo out with info="
    )]
    CameraChanged {
        /// fx of the first message (px).
        before: f64,
        /// fx of this one (px).
        now: f64,
    },
    /// Sensors or fingers are misnumbered.
    #[error(
        "{missing} is not there, and a later number is; numbers go on without gaps. Map {missing} to a topic, in the order of the scene's tables"
    )]
    Gap {
        /// The first missing one.
        missing: Topic,
    },
    /// A topic of another message type.
    #[error(
        "its messages are {found}, and {expected} is needed. Map another topic, or convert the messages before recording"
    )]
    WrongType {
        /// The type that is there; empty where none is named.
        found: String,
        /// The types that will do.
        expected: String,
    },
    /// Transforms without saying whose.
    #[error("it carries transforms between frames. Say which two, as object=/tf:table.tag_7")]
    FramesNeeded,
    /// Detections of tags, which have no pose on the table.
    #[error(
        "it carries where tags are in the image, and no poses on the table (those of Isaac ROS are in the camera's frame). The node that finds tags puts their poses on /tf: record it with /tf_static, and name the frames, as object=/tf:table.tag_7; `stickslip info` lists them"
    )]
    Detections,
    /// Frames that no transforms join.
    #[error(
        "no transforms lead from `{child}` to `{parent}`. Name two frames that are joined; the recording has {}",
        if .found.is_empty() { "none".to_owned() } else { listed(.found) }
    )]
    NoChain {
        /// The frame whose poses are wanted.
        child: String,
        /// The frame that they are wanted in.
        parent: String,
        /// All frames.
        found: Vec<String>,
    },
    /// A frame below two others.
    #[error(
        "the frame `{frame}` is below `{}` and `{}`; a frame has one parent. Record one publisher of it",
        .parents[0], .parents[1]
    )]
    TwoParents {
        /// The frame.
        frame: String,
        /// Its parents.
        parents: [String; 2],
    },
    /// A way between frames on which nothing moves.
    #[error("from {frames}, all transforms are static. Name the frame of a body that was tracked")]
    NothingMoves {
        /// The frames.
        frames: String,
    },
    /// A static transform that changes.
    #[error(
        "the static transform of `{frame}` is not that of message {first}; it must stay as it is. Publish what moves on /tf"
    )]
    StaticMoved {
        /// The frame.
        frame: String,
        /// Number of the message with the other transform.
        first: usize,
    },
    /// A tag whose place on the body is not given.
    #[error(
        "`{frame}` is not among the tags of the {body} in the scene, which has {}. Say there where it sits: [{body}] tags = {{ \"{frame}\" = [x, y, theta] }}",
        if .found.is_empty() { "none".to_owned() } else { listed(.found) }
    )]
    UnknownTag {
        /// The frame.
        frame: String,
        /// Body that carries it.
        body: Topic,
        /// The tags that the scene has.
        found: Vec<String>,
    },
    /// A message encoding that is not CDR.
    #[error(
        "its messages are encoded as `{found}`; only cdr, that of ROS 2, can be read. Record the topic with `ros2 bag record -s mcap`"
    )]
    WrongEncoding {
        /// The encoding.
        found: String,
    },
    /// CDR of a kind that ROS 2 does not write.
    #[error(
        "the message begins with the bytes {:02X} {:02X}; plain CDR begins with 00 00 or 00 01. A bag compressed message by message must be rewritten with `ros2 bag convert` first",
        .found[0], .found[1]
    )]
    Encapsulation {
        /// The first two bytes.
        found: [u8; 2],
    },
    /// A message that is far too large for its type.
    #[error(
        "a message on `{topic}` has {size} bytes, more than the {limit} that a pose, a force or a touch can have. Map another topic"
    )]
    LargeMessage {
        /// The topic.
        topic: String,
        /// Its bytes.
        size: usize,
        /// The most that are read.
        limit: usize,
    },
    /// A message that its type does not fit.
    #[error("the message is no {expected}: {why}. Record the topic again, or map another one")]
    Message {
        /// The type.
        expected: &'static str,
        /// The fault.
        why: String,
    },
    /// A stamp whose nanoseconds are a second or more.
    #[error(
        "header.stamp.nanosec is {found}; it must be below 1000000000. Correct what publishes the stamp"
    )]
    Nanoseconds {
        /// The nanoseconds.
        found: u32,
    },
    /// A clock that was set back.
    #[error(
        "{clock} jumps back from {from} to {to} s: the recording has several runs, or a clock was set. {}",
        match .log_times {
            Some([to, from]) => format!("Read one run: the log times up to {to} s, or those from {from} s on"),
            None => "Record each run in a bag of its own".to_owned(),
        }
    )]
    JumpsBack {
        /// The clock.
        clock: &'static str,
        /// Latest time before the jump (s).
        from: String,
        /// Time after it (s).
        to: String,
        /// Log times before and after the jump, if they tell the runs apart.
        log_times: Option<[LogTime; 2]>,
    },
    /// Two messages of a topic at one time.
    #[error(
        "header.stamp is {stamp} s, as in message {first}; each message of a topic needs a stamp of its own. Fill header.stamp with the time of measurement"
    )]
    SameStamp {
        /// The stamp (s).
        stamp: String,
        /// Number of the other message.
        first: usize,
    },
    /// Infinite or NaN.
    #[error(
        "{field} is {found}; numbers must be finite. Publish no message where nothing was measured"
    )]
    NotFinite {
        /// The field.
        field: &'static str,
        /// The number.
        found: f64,
    },
    /// A number that cannot be.
    #[error("{field} is {} m; it must be {rule}. Publish no message where nothing was measured", number::text(*.found))]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// The number.
        found: f64,
        /// Rule for the number.
        rule: String,
    },
    /// A quaternion that is no rotation.
    #[error(
        "the orientation's length is {found}; it must be 1 within 0.01. Correct the quaternion that is published"
    )]
    NotUnit {
        /// The length.
        found: f64,
    },
    /// Upside down, so that there is no angle about the vertical.
    #[error(
        "the pose is upside down, and its angle about z is undefined. Publish poses whose z-axis points up from the table"
    )]
    UpsideDown,
    /// Two frames.
    #[error("header.frame_id is `{found}`, and `{expected}` in {of}; all must be in one frame. Transform them before recording{}", if *.wrench { ", or leave forces out with wrench=" } else { "" })]
    Frame {
        /// The frame of this message.
        found: String,
        /// The frame of those before.
        expected: String,
        /// The topic that has it.
        of: String,
        /// True if this is the wrench, which can be left out.
        wrench: bool,
    },
    /// Stamps that are different and the same in seconds.
    #[error(
        "two rows are both at {time} s, since their stamps differ by less than numbers can tell. Record stamps further apart"
    )]
    SameTime {
        /// The time (s).
        time: f64,
    },
    /// Topics without a message.
    #[error(
        "there is no message on `{object}` or `{pusher}`; at least one is needed. Record while poses are published"
    )]
    NoRows {
        /// The object's topic.
        object: String,
        /// The pusher's topic.
        pusher: String,
    },
}
