//! Topics of a bag with a camera's images and with data that belong to them: [`CameraTopics`].

use std::str::FromStr;

use crate::log_mcap::topics::{Topic, TopicError, TopicMapping, Topics};
use crate::nearest::nearest;

/// Keys of a camera's topics, for suggestions.
const KEYS: [&str; 4] = ["image", "info", "wrench", "fixel_1"];

/// Ends of image topics that name how the image is packed, not which one it is.
const TRANSPORTS: [&str; 2] = ["compressed", "raw"];

/// A topic of a bag with images, as text `image=/camera/image_raw`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CameraMapping {
    /// The images.
    Image(String),
    /// The camera's numbers; `None` if they are not to be read.
    Info(Option<String>),
    /// A sensor's readings.
    Sensor(TopicMapping),
}

/// Topics of a bag with a camera's images, its CameraInfo, and the readings of sensors meanwhile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CameraTopics {
    image: String,
    info: Info,
    sensors: Topics,
}

/// Topic of the CameraInfo.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Info {
    /// Next to the images, if it is there.
    Beside(String),
    /// On this topic.
    Mapped(String),
    /// Not to be read.
    LeftOut,
}

impl FromStr for CameraMapping {
    type Err = TopicError;

    fn from_str(text: &str) -> Result<Self, TopicError> {
        let (key, name) = text
            .split_once('=')
            .ok_or_else(|| TopicError::NoTopic(text.to_owned()))?;
        let named = (!name.is_empty()).then(|| name.to_owned());
        match key {
            "image" => named.map(Self::Image).ok_or(TopicError::NoImages),
            "info" => Ok(Self::Info(named)),
            "object" | "pusher" => Err(TopicError::InImages(key.to_owned())),
            _ => match text.parse() {
                Ok(mapping) => Ok(Self::Sensor(mapping)),
                Err(TopicError::UnknownKey { found, .. }) => {
                    let closest = nearest(&found, KEYS).map_or("image", |(name, _)| name);
                    let nearest = closest.to_owned();
                    Err(TopicError::UnknownCameraKey { found, nearest })
                }
                Err(error) => Err(error),
            },
        }
    }
}

impl CameraTopics {
    /// The topics that are mapped. CameraInfo that is not mapped is sought next to the images, as
    /// in ROS 2: `/camera/camera_info` for `/camera/image_raw` and `/camera/image_raw/compressed`.
    ///
    /// # Errors
    /// No images are mapped, or something twice.
    ///
    /// ```
    /// use stickslip_formats::CameraTopics;
    /// let topics = CameraTopics::new(["image=/cam/image_raw/compressed".parse()?])?;
    /// assert_eq!((topics.image(), topics.info()), ("/cam/image_raw/compressed", Some("/cam/camera_info")));
    /// # Ok::<(), stickslip_formats::TopicError>(())
    /// ```
    pub fn new(mappings: impl IntoIterator<Item = CameraMapping>) -> Result<Self, TopicError> {
        let (mut image, mut info, mut sensors) = (None, None, Vec::new());
        for mapping in mappings {
            match mapping {
                CameraMapping::Image(name) => once("image", &mut image, name)?,
                CameraMapping::Info(name) => once("info", &mut info, name.unwrap_or_default())?,
                CameraMapping::Sensor(mapping) => sensors.push(mapping),
            }
        }
        let image = image.ok_or(TopicError::NoImages)?;
        let info = match info {
            None => Info::Beside(beside(&image)),
            Some(name) if name.is_empty() => Info::LeftOut,
            Some(name) => Info::Mapped(name),
        };
        Ok(Self {
            image,
            info,
            sensors: Topics::new(sensors)?,
        })
    }

    /// Name of the topic with the images.
    #[must_use]
    pub fn image(&self) -> &str {
        &self.image
    }

    /// Name of the topic with the camera's numbers; `None` if they are not to be read.
    #[must_use]
    pub fn info(&self) -> Option<&str> {
        match &self.info {
            Info::Beside(name) | Info::Mapped(name) => Some(name),
            Info::LeftOut => None,
        }
    }

    /// Returns true if the name of the topic says that its images were rectified. The distortion of
    /// CameraInfo is then no longer in them.
    #[must_use]
    pub fn is_rectified(&self) -> bool {
        self.image
            .split('/')
            .any(|part| part.starts_with("image_rect") || part == "rectified")
    }

    /// Returns true if the topic with the camera's numbers is mapped, and so must be there.
    pub(crate) fn needs_info(&self) -> bool {
        matches!(self.info, Info::Mapped(_))
    }

    /// The topics of sensors: those of touch, and of forces only where they are mapped, since their
    /// frame cannot be compared with that of any pose.
    pub(crate) fn sensors(&self) -> &Topics {
        &self.sensors
    }

    /// Returns true if a topic of a recording is that of a sensor.
    pub(crate) fn is_sensor(&self, name: &str) -> bool {
        match self.sensors.carries(name) {
            Some(Topic::Fixel(_)) => true,
            Some(Topic::Wrench) => self.sensors.is_mapped(Topic::Wrench),
            Some(Topic::Object | Topic::Pusher | Topic::Finger(_)) | None => false,
        }
    }
}

fn once(key: &'static str, at: &mut Option<String>, name: String) -> Result<(), TopicError> {
    match at.replace(name.clone()) {
        None => Ok(()),
        Some(first) => Err(TopicError::CameraTwice {
            key,
            first,
            second: name,
        }),
    }
}

/// The topic with the camera's numbers that belongs to one with images, by the convention of ROS 2.
fn beside(image: &str) -> String {
    let is_transport = |name: &(&str, &str)| TRANSPORTS.contains(&name.1);
    let image = image
        .rsplit_once('/')
        .filter(is_transport)
        .map_or(image, |(image, _)| image);
    let folder = image.rsplit_once('/').map_or("", |(folder, _)| folder);
    format!("{folder}/camera_info")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topics(mappings: &[&str]) -> Result<CameraTopics, TopicError> {
        let mappings: Vec<CameraMapping> = mappings
            .iter()
            .map(|text| text.parse())
            .collect::<Result<_, _>>()?;
        CameraTopics::new(mappings)
    }

    #[test]
    fn camera_info_is_beside_the_images_but_where_it_is_mapped() {
        for (mappings, info) in [
            (&["image=/image_raw"][..], Some("/camera_info")),
            (&["image=image"], Some("/camera_info")),
            (
                &["image=/a/b/image_color/compressed"],
                Some("/a/b/camera_info"),
            ),
            (&["image=/a/image", "info=/left/info"], Some("/left/info")),
            (&["info=", "image=/a/image"], None),
        ] {
            assert_eq!(topics(mappings).unwrap().info(), info, "{mappings:?}");
        }
    }

    #[test]
    fn topics_say_which_sensors_are_read() {
        let topics = topics(&["image=/image", "fixel_1=/bumper"]).unwrap();
        for (name, is_one) in [
            ("/bumper", true),
            ("/fixel_1/contact", false),
            ("/fixel_2/contact", true),
            ("/pusher/wrench", false),
            ("/object/pose", false),
        ] {
            assert_eq!(topics.is_sensor(name), is_one, "{name}");
        }
    }

    #[test]
    fn rectified_images_are_told_by_name() {
        for (name, is_one) in [
            ("/cam/image_rect", true),
            ("/cam/image_rect_color/compressed", true),
            ("/cam/image_raw", false),
            ("/direct/image", false),
        ] {
            let topics = topics(&[&format!("image={name}")]).unwrap();
            assert_eq!(topics.is_rectified(), is_one, "{name}");
        }
    }

    #[test]
    fn mappings_are_refused_with_words() {
        for (mappings, words) in [
            (&[][..], "no topic of images is named"),
            (&["image="], "no topic of images is named"),
            (
                &["image=/a", "image=/b"],
                "image is mapped to `/a` and to `/b`",
            ),
            (&["object=/a"], "object is found in the images"),
            (&["imge=/a"], "the nearest is image"),
            (&["image"], "has no `=`"),
        ] {
            let message = topics(mappings).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
