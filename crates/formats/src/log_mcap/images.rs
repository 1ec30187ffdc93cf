//! Images of a bag, one after the other: [`read_bag_images`], and the camera's numbers:
//! [`read_bag_camera_info`].

use std::collections::BTreeMap;
use std::io::Read;
use std::ops::ControlFlow;

use crate::log_mcap::camera_topics::CameraTopics;
use crate::log_mcap::error::{McapError, McapPlace, McapProblem};
use crate::log_mcap::image_message::{
    BagCameraInfo, BagImage, IMAGE_TYPES, INFO_TYPE, decode_camera_info, decode_image,
};
use crate::log_mcap::messages::{Kind, Recorded, Visitor, message_data, messages};
use crate::log_mcap::read::whole;
use crate::log_mcap::recording::{Keeper, Recording, Wanted};
use crate::log_mcap::records::{CHUNK_LIMIT, Stop};
use crate::log_mcap::series::seconds_text;
use crate::log_mcap::source::ENCODING;

/// Most bytes of an image's message: a chunk holds no more.
const LARGEST_IMAGE: usize = CHUNK_LIMIT as usize;

/// Reads how the camera maps directions to pixels, from the first message on its topic; `None`
/// where there is none, or it is not to be read. Files are read no further than that message.
///
/// # Errors
/// The bytes are no MCAP file or cannot be read; the topic is mapped and not there, or has messages
/// of another type; a number is not finite.
pub fn read_bag_camera_info<R: Read>(
    files: impl IntoIterator<Item = (String, R)>,
    topics: &CameraTopics,
) -> Result<Option<BagCameraInfo>, McapError> {
    let Some(topic) = topics.info() else {
        return Ok(None);
    };
    let mut visitor = InfoVisitor {
        topic,
        found: None,
        names: BTreeMap::new(),
    };
    let mut names = Vec::new();
    for (number, (name, file)) in files.into_iter().enumerate() {
        names.push(name);
        let read = messages(file, number, &mut visitor);
        read.map_err(|problem| whole(&names, problem))?;
        match visitor.found.take() {
            Some(Ok(info)) => return Ok(Some(info)),
            Some(Err(problem)) => return Err(of_topic(&names, topic, problem)),
            None => {}
        }
    }
    match topics.needs_info() {
        true => Err(whole(
            &names[..names.len().min(1)],
            no_such_topic("info", topic, &[INFO_TYPE], &visitor.names),
        )),
        false => Ok(None),
    }
}

/// Shows the images of a bag to `take`, in the order of its files, until that says to break. One
/// chunk of at most 256 MiB is in memory, and the image that is shown.
///
/// Returns the readings of sensors up to there.
///
/// # Errors
/// - Those of `take`.
/// - The bytes are no MCAP file or cannot be read.
/// - The images' topic is not there or has messages of another type.
/// - A message does not fit its type, or two images have one stamp.
/// - A message of CameraInfo says something else than the first one.
pub fn read_bag_images<R: Read, E: From<McapError>>(
    files: impl IntoIterator<Item = (String, R)>,
    topics: &CameraTopics,
    take: &mut dyn FnMut(BagImage) -> Result<ControlFlow<()>, E>,
) -> Result<CameraRecording, E> {
    let mut names = Vec::new();
    let mut recording = Recording::default();
    let mut images = Images::new(topics, take);
    for (number, (name, file)) in files.into_iter().enumerate() {
        images.file.clone_from(&name);
        images.number = 0;
        names.push(name);
        let damage = messages(
            file,
            number,
            &mut ImageVisitor {
                images: &mut images,
                sensors: recording.keeper(topics),
            },
        );
        let damage = damage.map_err(|problem| whole(&names, problem))?;
        recording.damage.extend(damage);
        match images.ended.take() {
            Some(Ok(())) => break,
            Some(Err(error)) => return Err(error),
            None => {}
        }
    }
    if images.schema.is_none() {
        let all = recording.names.iter();
        let all = all.map(|(name, seen)| (name.clone(), seen.schema.clone()));
        let problem = no_such_topic("image", topics.image(), &IMAGE_TYPES, &all.collect());
        return Err(whole(&names[..names.len().min(1)], problem).into());
    }
    Ok(CameraRecording {
        files: names,
        recording,
    })
}

/// Content of a bag besides its images.
#[derive(Debug)]
pub struct CameraRecording {
    pub(crate) files: Vec<String>,
    pub(crate) recording: Recording,
}

impl Wanted for CameraTopics {
    fn wants(&self, name: &str, _: &str) -> bool {
        self.is_sensor(name)
    }
}

/// The topic of a camera that a bag lacks.
fn no_such_topic(
    key: &'static str,
    name: &str,
    types: &[&str],
    recorded: &BTreeMap<String, String>,
) -> McapProblem {
    let of_type = recorded
        .iter()
        .filter(|(_, schema)| types.contains(&schema.as_str()));
    McapProblem::NoCameraTopic {
        key,
        name: name.to_owned(),
        found: of_type.map(|(name, _)| name.clone()).collect(),
    }
}

/// An error of a whole topic, reported for the latest file.
fn of_topic(files: &[String], topic: &str, problem: McapProblem) -> McapError {
    let place = Some(McapPlace {
        topic: topic.to_owned(),
        message: None,
    });
    McapError {
        place,
        ..whole(files, problem)
    }
}

/// Refuses a channel of another type or encoding.
fn check_kind(kind: &Kind, types: &[&str]) -> Result<(), McapProblem> {
    if !types.contains(&kind.schema.as_str()) {
        return Err(McapProblem::WrongType {
            found: match kind.schema.as_str() {
                "" => "without a type".to_owned(),
                schema => schema.to_owned(),
            },
            expected: types.join(" or "),
        });
    }
    if kind.encoding != ENCODING {
        let found = kind.encoding.clone();
        return Err(McapProblem::WrongEncoding { found });
    }
    Ok(())
}

/// Looks for the first message of CameraInfo.
struct InfoVisitor<'t> {
    topic: &'t str,
    found: Option<Result<BagCameraInfo, McapProblem>>,
    /// Types of all topics by name.
    names: BTreeMap<String, String>,
}

impl Visitor for InfoVisitor<'_> {
    fn channel(&mut self, topic: &str, kind: Kind) -> Result<(), Stop> {
        if topic == self.topic
            && let Err(problem) = check_kind(&kind, &[INFO_TYPE])
        {
            self.found = Some(Err(problem));
            return Err(Stop::Enough);
        }
        self.names.insert(topic.to_owned(), kind.schema);
        Ok(())
    }

    fn message(&mut self, message: Recorded<'_>) -> Result<(), Stop> {
        if message.topic != self.topic {
            return Ok(());
        }
        let data = message_data(message.topic, message.data, LARGEST_IMAGE)?;
        self.found = Some(decode_camera_info(&data));
        Err(Stop::Enough)
    }
}

/// The images so far.
struct Images<'t, E> {
    topics: &'t CameraTopics,
    take: &'t mut dyn FnMut(BagImage) -> Result<ControlFlow<()>, E>,
    /// The file that is read.
    file: String,
    /// Images of that file.
    number: usize,
    /// Type of the images.
    schema: Option<String>,
    /// Numbers of the images in their files by stamp.
    stamps: BTreeMap<i64, usize>,
    info: Option<BagCameraInfo>,
    /// Result with which it ended before the end of the bag.
    ended: Option<Result<(), E>>,
}

impl<'t, E: From<McapError>> Images<'t, E> {
    fn new(
        topics: &'t CameraTopics,
        take: &'t mut dyn FnMut(BagImage) -> Result<ControlFlow<()>, E>,
    ) -> Self {
        Self {
            topics,
            take,
            file: String::new(),
            number: 0,
            schema: None,
            stamps: BTreeMap::new(),
            info: None,
            ended: None,
        }
    }

    /// Ends with an error in the topic of a message.
    fn refuse(&mut self, topic: &str, message: Option<(usize, u64)>, problem: McapProblem) -> Stop {
        let place = McapPlace {
            topic: topic.to_owned(),
            message,
        };
        let error = McapError {
            file: self.file.clone(),
            place: Some(place),
            problem: Box::new(problem),
        };
        self.ended = Some(Err(error.into()));
        Stop::Enough
    }

    fn channel(&mut self, topic: &str, kind: &Kind) -> Result<(), Stop> {
        if topic != self.topics.image() {
            return Ok(());
        }
        let first = self.schema.get_or_insert_with(|| kind.schema.clone());
        let types = match *first == kind.schema {
            true => IMAGE_TYPES.to_vec(),
            false => vec![first.as_str()],
        };
        let checked = check_kind(kind, &types);
        checked.map_err(|problem| self.refuse(topic, None, problem))
    }

    fn image(&mut self, message: Recorded<'_>) -> Result<(), Stop> {
        let Recorded {
            topic,
            log_time,
            data,
            ..
        } = message;
        self.number += 1;
        let place = Some((self.number, log_time));
        let data = message_data(topic, data, LARGEST_IMAGE)?;
        let schema = self.schema.clone().unwrap_or_default();
        let (stamp, picture) =
            decode_image(&schema, &data).map_err(|problem| self.refuse(topic, place, problem))?;
        if let Some(first) = self.stamps.insert(stamp, self.number) {
            let stamp = seconds_text(stamp);
            return Err(self.refuse(topic, place, McapProblem::SameStamp { stamp, first }));
        }
        let image = BagImage {
            name: format!("{}: {topic}, message {}", self.file, self.number),
            number: self.number,
            stamp,
            picture,
        };
        match (self.take)(image) {
            Ok(ControlFlow::Continue(())) => return Ok(()),
            Ok(ControlFlow::Break(())) => self.ended = Some(Ok(())),
            Err(error) => self.ended = Some(Err(error)),
        }
        Err(Stop::Enough)
    }

    /// Compares CameraInfo with the first one.
    fn info(&mut self, message: Recorded<'_>) -> Result<(), Stop> {
        let topic = message.topic;
        let data = message_data(topic, message.data, LARGEST_IMAGE)?;
        let info =
            decode_camera_info(&data).map_err(|problem| self.refuse(topic, None, problem))?;
        let first = self.info.get_or_insert_with(|| info.clone());
        if *first == info {
            return Ok(());
        }
        let (before, now) = (first.matrix[0], info.matrix[0]);
        Err(self.refuse(topic, None, McapProblem::CameraChanged { before, now }))
    }
}

/// Shows images, and keeps the readings of sensors.
struct ImageVisitor<'v, 't, E> {
    images: &'v mut Images<'t, E>,
    sensors: Keeper<'v>,
}

impl<E: From<McapError>> Visitor for ImageVisitor<'_, '_, E> {
    fn channel(&mut self, topic: &str, kind: Kind) -> Result<(), Stop> {
        self.images.channel(topic, &kind)?;
        self.sensors.channel(topic, kind)
    }

    fn message(&mut self, message: Recorded<'_>) -> Result<(), Stop> {
        if message.topic == self.images.topics.image() {
            return self.images.image(message);
        }
        if Some(message.topic) == self.images.topics.info() {
            return self.images.info(message);
        }
        self.sensors.message(message)
    }
}
