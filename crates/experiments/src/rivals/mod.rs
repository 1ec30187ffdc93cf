//! Two methods that the paper argues against, as rivals of its own: pose noise in the place of a
//! random force ([`PoseNoise`], §III-B), and polygons in the place of quadratic friction cones
//! ([`PolygonCone`], §II-B).

mod cone_rollout;
mod lemke;
mod overlap_count;
mod polygon_cone;
mod pose_noise;

pub use cone_rollout::ConeRollout;
pub use lemke::{Lcp, LemkeEnd};
pub use overlap_count::OverlapCount;
pub use polygon_cone::{PolygonCone, PolygonStep};
pub use pose_noise::{PoseNoise, PoseNoiseRun};
