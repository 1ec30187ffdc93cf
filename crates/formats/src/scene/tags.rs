//! `tags = { tag_7 = [x, y, theta] }` of object and pusher.

use std::collections::BTreeMap;

use stickslip::{Rule, Unit};
use stickslip_dynamics::Pose;

use super::document::Table;
use super::error::SceneError;
use super::quantity::Quantity;
use crate::mounts::Mounts;

const TAGS: &str = "the tags' poses on the body as { FRAME = [x, y, theta], ... } in m and rad";
const POSITION: Quantity = Quantity::new(
    "tags",
    "the position of the tag's centre in the body's frame, in [x, y, theta],",
    Unit::Metre,
    Rule::Finite,
);
const ANGLE: Quantity = Quantity::new(
    "tags",
    "the angle of the tag's x-axis in the body's frame, in [x, y, theta],",
    Unit::Radian,
    Rule::Finite,
);

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
    let pose = |(name, node): (String, super::document::Node<'_>)| {
        let [x, y, theta] = node.exactly::<3>(TAGS)?;
        let pose = Pose::new(
            x.number(&POSITION)?,
            y.number(&POSITION)?,
            theta.number(&ANGLE)?,
        );
        Ok((name, pose))
    };
    node.entries(TAGS)?.into_iter().map(pose).collect()
}
