//! Places of tags on the bodies: [`Mounts`].

use std::collections::BTreeMap;

use stickslip_dynamics::Pose;

/// Poses of tags on object and pusher by the names of their frames, as `tags` in `scene.toml` has
/// them: where a tag's centre is in the body's frame (m), and the angle there of the tag's x-axis
/// (rad). A body without any is tracked by its own frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mounts {
    /// Tags on the object.
    pub object: BTreeMap<String, Pose>,
    /// Tags on the pusher.
    pub pusher: BTreeMap<String, Pose>,
}

/// The pose of a body whose tag, mounted at `mount` on it, is at `tag`.
pub(crate) fn body_of(tag: Pose, mount: Pose) -> Pose {
    let body = Pose::new(0.0, 0.0, tag.theta - mount.theta);
    let [x, y] = body.rotate([mount.x, mount.y]);
    Pose::new(tag.x - x, tag.y - y, body.theta)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn body_of_undoes_where_the_tag_is_mounted() {
        let (body, mount) = (Pose::new(0.3, -0.2, 2.5), Pose::new(0.01, -0.02, 0.7));
        let [x, y] = body.transform([mount.x, mount.y]);
        let found = body_of(Pose::new(x, y, body.theta + mount.theta), mount);
        let apart = [found.x - body.x, found.y - body.y, found.theta - body.theta];
        assert!(apart.iter().all(|d| d.abs() < 1e-15), "{found:?}");
    }
}
