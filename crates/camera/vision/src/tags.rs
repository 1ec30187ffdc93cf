//! Tags of each body, and their places: [`Tags`], tags.toml.

use serde::Deserialize;
use stickslip_dynamics::Pose;

use crate::config::{ConfigError, Document};
use crate::planar_pose::TagPlace;
use crate::tag::TAG_COUNT;

/// A tag on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyTag {
    /// Number of the tag.
    pub id: u16,
    /// Its place on the body.
    pub place: TagPlace,
}

/// The tags of object and pusher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tags {
    /// The object's.
    pub object: BodyTag,
    /// The pusher's.
    pub pusher: BodyTag,
}

/// tags.toml as it stands.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TagsFile {
    object: BodyTable,
    pusher: BodyTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyTable {
    tag: u16,
    size: f64,
    height: f64,
    #[serde(default)]
    pose: [f64; 3],
}

/// Reads tags.toml; `name` is shown in errors.
///
/// # Errors
/// Not TOML, a key that is missing, unknown or of another type, or a number against its rule, each
/// with file and line.
///
/// ```
/// let text = "[object]\ntag = 0\nsize = 0.028\nheight = 0.02\n[pusher]\ntag = 1\nsize = 0.024\nheight = 0.03\npose = [-0.015, 0, 0]\n";
/// let tags = stickslip_vision::read_tags(text, "tags.toml")?;
/// assert_eq!((tags.object.id, tags.pusher.id, tags.pusher.place.pose.x), (0, 1, -0.015));
/// # Ok::<(), stickslip_vision::ConfigError>(())
/// ```
pub fn read_tags(text: &str, name: &str) -> Result<Tags, ConfigError> {
    let document = Document { name, text };
    let file: TagsFile =
        document.parse("Give [object] and [pusher], each with tag, size and height in metres, and if needed pose = [x, y, angle]")?;
    let tags = Tags {
        object: file.object.check(&document, "object")?,
        pusher: file.pusher.check(&document, "pusher")?,
    };
    let other = format!("another tag than the object's, {}", tags.object.id);
    document.require(
        tags.object.id != tags.pusher.id,
        "pusher.tag",
        tags.pusher.id.to_string(),
        &other,
    )?;
    Ok(tags)
}

/// Tags as tags.toml; every number reads back to the same bits.
pub fn write_tags(tags: &Tags) -> String {
    let table = |body: &str,
                 BodyTag {
                     id,
                     place: TagPlace { size, height, pose },
                 }: &BodyTag| {
        let Pose { x, y, theta } = pose;
        format!(
            "[{body}]\ntag = {id}\nsize = {size}\nheight = {height}\npose = [{x}, {y}, {theta}]\n"
        )
    };
    format!(
        "# AprilTags 36h11. size: edge of the black square (m); height: of the print above the table (m);\n\
         # pose: x, y (m), angle (rad) of the tag (origin in its middle, x right, y up as printed) in the body's frame.\n\n{}\n{}",
        table("object", &tags.object),
        table("pusher", &tags.pusher)
    )
}

impl BodyTable {
    fn check(&self, document: &Document<'_>, body: &str) -> Result<BodyTag, ConfigError> {
        let key = |name: &str| format!("{body}.{name}");
        let last = format!("in 0 to {}, the numbers of the family 36h11", TAG_COUNT - 1);
        document.require(
            self.tag < TAG_COUNT,
            &key("tag"),
            self.tag.to_string(),
            &last,
        )?;
        document.require(
            (1e-3..2.0).contains(&self.size),
            &key("size"),
            format!("{} m", self.size),
            "between 0.001 m and 2 m",
        )?;
        document.require(
            (0.0..2.0).contains(&self.height),
            &key("height"),
            format!("{} m", self.height),
            "between 0 m and 2 m",
        )?;
        let near = self.pose.iter().all(|x| x.is_finite())
            && self.pose[0].abs() < 2.0
            && self.pose[1].abs() < 2.0;
        document.require(
            near,
            &key("pose"),
            format!("{:?}", self.pose),
            "[x, y, angle], x and y within 2 m of the body's origin",
        )?;
        let [x, y, theta] = self.pose;
        Ok(BodyTag {
            id: self.tag,
            place: TagPlace {
                size: self.size,
                height: self.height,
                pose: Pose::new(x, y, theta),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[object]\ntag = 0\nsize = 0.028\nheight = 0.02\n\n[pusher]\ntag = 1\nsize = 0.024\nheight = 0.03\npose = [0.1, 0, 0]\n";

    #[test]
    fn write_tags_reads_back() {
        let tags = read_tags(GOOD, "t").unwrap();
        assert_eq!(read_tags(&write_tags(&tags), "t").unwrap(), tags);
    }

    #[test]
    fn read_tags_names_line_value_rule_and_next_step() {
        for (from, to, words) in [
            (
                "tag = 0",
                "tag = 600",
                ["t:2: `object.tag` is 600", "in 0 to 586"],
            ),
            (
                "tag = 1",
                "tag = 0",
                ["t:7: `pusher.tag` is 0", "another tag than the object's, 0"],
            ),
            (
                "size = 0.024",
                "size = 24",
                ["t:8: `pusher.size` is 24 m", "between 0.001 m and 2 m"],
            ),
            (
                "height = 0.02\n",
                "height = -0.02\n",
                ["t:4: `object.height` is -0.02 m", "between 0 m and 2 m"],
            ),
            (
                "pose = [0.1, 0, 0]",
                "pose = [100, 0, 0]",
                ["t:10: `pusher.pose` is [100.0, 0.0, 0.0]", "within 2 m"],
            ),
            (
                "[pusher]",
                "[psher]",
                [
                    "t:6: `[psher]`: unknown field `psher`",
                    "Give [object] and [pusher]",
                ],
            ),
        ] {
            let text = read_tags(&GOOD.replace(from, to), "t")
                .unwrap_err()
                .to_string();
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        }
    }
}
