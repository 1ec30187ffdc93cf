//! Messages that carry one pose, whatever else they say: [`StampedPose`].

use serde::{Deserialize, Serialize};

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::message::{Header, Message, PoseStamped, Quaternion, Vector3, decode};

/// Six by six numbers, row by row.
pub(crate) type Covariance = [[f64; 6]; 6];

/// `geometry_msgs/msg/PoseWithCovarianceStamped`, laid out flat; where one is read, the covariance is
/// not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseWithCovarianceStamped {
    pub header: Header,
    pub position: Vector3,
    pub orientation: Quaternion,
    pub covariance: Covariance,
}

/// `nav_msgs/msg/Odometry`, laid out flat; only its pose is used.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Odometry {
    header: Header,
    #[serde(rename = "child_frame_id")]
    _child: String,
    position: Vector3,
    orientation: Quaternion,
    #[serde(rename = "covariance")]
    _covariance: Covariance,
    #[serde(rename = "twist")]
    _twist: [f64; 6],
    #[serde(rename = "twist_covariance")]
    _twist_covariance: Covariance,
}

/// `geometry_msgs/msg/TransformStamped`, laid out flat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub translation: Vector3,
    pub rotation: Quaternion,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TfMessage {
    pub transforms: Vec<TransformStamped>,
}

impl Message for PoseWithCovarianceStamped {
    const TYPE: &'static str = "geometry_msgs/msg/PoseWithCovarianceStamped";
}

impl Message for Odometry {
    const TYPE: &'static str = "nav_msgs/msg/Odometry";
}

impl Message for TransformStamped {
    const TYPE: &'static str = "geometry_msgs/msg/TransformStamped";
}

impl Message for TfMessage {
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
}

/// A pose with its header.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StampedPose {
    pub header: Header,
    pub position: Vector3,
    pub orientation: Quaternion,
}

/// A message type that carries one pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PoseKind {
    Stamped,
    WithCovariance,
    Transform,
    Odometry,
}

impl PoseKind {
    /// Names of all types that carry one pose.
    pub(crate) const TYPES: [&'static str; 4] = [
        PoseStamped::TYPE,
        PoseWithCovarianceStamped::TYPE,
        TransformStamped::TYPE,
        Odometry::TYPE,
    ];

    /// The kind of a message type; `None` for one without a pose.
    pub(crate) fn of(schema: &str) -> Option<Self> {
        let kinds = [
            Self::Stamped,
            Self::WithCovariance,
            Self::Transform,
            Self::Odometry,
        ];
        let index = Self::TYPES.iter().position(|name| *name == schema)?;
        Some(kinds[index])
    }

    /// The pose of a message.
    pub(crate) fn decode(self, bytes: &[u8]) -> Result<StampedPose, McapProblem> {
        let (header, position, orientation) = match self {
            Self::Stamped => {
                let m: PoseStamped = decode(bytes)?;
                (m.header, m.position, m.orientation)
            }
            Self::WithCovariance => {
                let m: PoseWithCovarianceStamped = decode(bytes)?;
                (m.header, m.position, m.orientation)
            }
            Self::Transform => {
                let m: TransformStamped = decode(bytes)?;
                (m.header, m.translation, m.rotation)
            }
            Self::Odometry => {
                let m: Odometry = decode(bytes)?;
                (m.header, m.position, m.orientation)
            }
        };
        Ok(StampedPose {
            header,
            position,
            orientation,
        })
    }
}
