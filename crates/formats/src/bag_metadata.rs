//! `metadata.yaml` of a bag's folder: [`read_bag_metadata`].

use std::path::{Component, Path};

use serde::{Deserialize, Deserializer};

/// Most bytes of the file; one with hundreds of topics and splits has 100 kB.
const LIMIT: usize = 1 << 24;

/// Content of a bag's `metadata.yaml`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct BagMetadata {
    /// Storage of its files, `mcap` or `sqlite3`; empty after `ros2 bag reindex`.
    #[serde(default, deserialize_with = "text_or_nothing")]
    pub storage_identifier: String,
    /// Its files in the order of recording, from the bag's folder.
    pub relative_file_paths: Vec<String>,
}

/// A text; empty where the key has no value.
fn text_or_nothing<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_default())
}

impl BagMetadata {
    /// Storage of the files if it is not MCAP; the ending of a file decides where none is named.
    #[must_use]
    pub fn other_storage(&self) -> Option<&str> {
        match self.storage_identifier.trim() {
            "mcap" => None,
            "" => {
                let is_sqlite = |path: &String| path.to_lowercase().ends_with(".db3");
                let any = self.relative_file_paths.iter().any(is_sqlite);
                any.then_some("sqlite3")
            }
            other => Some(other),
        }
    }
}

/// Reason why `metadata.yaml` was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BagMetadataError {
    /// Far too large.
    #[error(
        "{file}: the file has {size} bytes; at most {LIMIT} are read. Give the folder of a bag"
    )]
    Size {
        /// Display name of the file.
        file: String,
        /// Its bytes.
        size: usize,
    },
    /// No such document.
    #[error(
        "{file}: this is no metadata of a bag: {why}. Rewrite it with `ros2 bag reindex`, or give the .mcap file itself"
    )]
    Content {
        /// Display name of the file.
        file: String,
        /// The fault, with line and column.
        why: String,
    },
    /// A file elsewhere.
    #[error(
        "{file}: relative_file_paths has `{found}`; a bag's files lie in its folder. Rewrite it with `ros2 bag reindex`, or give the .mcap file itself"
    )]
    Outside {
        /// Display name of the file.
        file: String,
        /// The path.
        found: String,
    },
}

#[derive(Deserialize)]
struct Document {
    rosbag2_bagfile_information: BagMetadata,
}

/// Reads `metadata.yaml` of a bag's folder; `name` is shown in errors. It parses only what is
/// needed to find the files.
///
/// # Errors
/// No YAML, a missing key or one of another type, a path that leaves the folder, 16 MiB and more.
///
/// ```
/// let yaml = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  relative_file_paths: [push_0.mcap, push_1.mcap]\n";
/// let bag = stickslip_formats::read_bag_metadata(yaml, "push/metadata.yaml")?;
/// assert_eq!(bag.relative_file_paths, ["push_0.mcap", "push_1.mcap"]);
/// # Ok::<(), stickslip_formats::BagMetadataError>(())
/// ```
pub fn read_bag_metadata(text: &str, name: &str) -> Result<BagMetadata, BagMetadataError> {
    let file = || name.to_owned();
    if text.len() > LIMIT {
        let size = text.len();
        return Err(BagMetadataError::Size { file: file(), size });
    }
    let parsed: Result<Document, _> = serde_saphyr::from_str(text);
    let document = parsed.map_err(|error| BagMetadataError::Content {
        file: file(),
        why: error
            .to_string()
            .lines()
            .next()
            .unwrap_or_default()
            .to_owned(),
    })?;
    let bag = document.rosbag2_bagfile_information;
    let inside = |path: &&String| {
        let mut parts = Path::new(path).components();
        !path.is_empty()
            && parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
    };
    match bag.relative_file_paths.iter().find(|path| !inside(path)) {
        None => Ok(bag),
        Some(found) => Err(BagMetadataError::Outside {
            file: file(),
            found: found.clone(),
        }),
    }
}
