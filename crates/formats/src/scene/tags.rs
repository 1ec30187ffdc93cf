//! `tags = { tag_7 = [x, y, theta] }` of object and pusher.

use std::collections::BTreeMap;

use stickslip_dynamics::Pose;

use super::document::Table;
use super::error::SceneError;
use crate::mounts::Mounts;

/// The tags on both bodies.
pub(super) fn mounts(root: &Table<'_>) -> Result<Mounts, SceneError> {
    Ok(Mounts {
        object: tags(&root.section("object")?)?,
        pusher: tags(&root.section("pusher")?)?,
    })
}

fn tags(body: &Table<'_>) -> Result<BTreeMap<String, Pose>, SceneError> {
    let Some(node) = body.optional("tags") else {
        return Ok(BTreeMap::new());
    };
    let named = node.entries()?.into_iter();
    named.map(|(name, tag)| Ok((name, tag.pose()?))).collect()
}
