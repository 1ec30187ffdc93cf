//! The pusher's motion, from its measured poses to the substeps that drive the object.

pub(crate) mod causal;
pub(crate) mod jumps;
pub(crate) mod schedule;
pub(crate) mod smoothed;
pub(crate) mod track;
pub(crate) mod tracked_pose;
