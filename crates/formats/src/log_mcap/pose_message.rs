//! Messages that carry one pose, whatever else they say: [`StampedPose`].

use serde::{Deserialize, Serialize};
use stickslip::PoseCovariance;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::message::{Header, Message, PoseStamped, Quaternion, Vector3, decode};

/// Six by six numbers, row by row.
pub(crate) type Covariance = [[f64; 6]; 6];

/// `geometry_msgs/msg/PoseWithCovarianceStamped`, laid out flat.
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
    covariance: Covariance,
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
    pub noise: ToldNoise,
}

/// Noise of a pose by its message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ToldNoise {
    /// Nothing: its type has no covariance, or that is 0 throughout, as where it is not known.
    Unknown,
    /// The covariance of x, y and the turn about z.
    Known(PoseCovariance),
    /// Numbers that are no covariance.
    Impossible,
}

impl ToldNoise {
    /// Of the covariance of x, y, z and turns about the three axes.
    fn of(covariance: &Covariance) -> Self {
        /// Indices of x, y and the turn about z.
        const PLANAR: [usize; 3] = [0, 1, 5];
        let [x, y, theta] = PLANAR.map(|k| covariance[k][k]);
        let [x_y, x_theta, y_theta] = [(0, 1), (0, 5), (1, 5)].map(|(i, j)| covariance[i][j]);
        let planar = PoseCovariance {
            x,
            y,
            theta,
            x_y,
            x_theta,
            y_theta,
        };
        let symmetric = [(0, 1), (0, 5), (1, 5)].into_iter().all(|(i, j)| {
            let (a, b) = (covariance[i][j], covariance[j][i]);
            (a - b).abs() <= ASYMMETRY * (covariance[i][i] * covariance[j][j]).abs().sqrt()
        });
        match planar {
            planar if planar.is_unknown() && symmetric => Self::Unknown,
            planar if planar.is_valid() && symmetric => Self::Known(planar),
            _ => Self::Impossible,
        }
    }
}

/// Largest difference between the two halves of a covariance, as a correlation.
const ASYMMETRY: f64 = 1e-6;

/// A covariance of x, y and the turn about z in that of a pose in space, 0 elsewhere.
pub(crate) fn spatial_covariance(planar: &PoseCovariance) -> Covariance {
    let mut covariance = [[0.0; 6]; 6];
    for (i, j, number) in [
        (0, 0, planar.x),
        (1, 1, planar.y),
        (5, 5, planar.theta),
        (0, 1, planar.x_y),
        (0, 5, planar.x_theta),
        (1, 5, planar.y_theta),
    ] {
        covariance[i][j] = number;
        covariance[j][i] = number;
    }
    covariance
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
        let mut noise = ToldNoise::Unknown;
        let (header, position, orientation) = match self {
            Self::Stamped => {
                let m: PoseStamped = decode(bytes)?;
                (m.header, m.position, m.orientation)
            }
            Self::WithCovariance => {
                let m: PoseWithCovarianceStamped = decode(bytes)?;
                noise = ToldNoise::of(&m.covariance);
                (m.header, m.position, m.orientation)
            }
            Self::Transform => {
                let m: TransformStamped = decode(bytes)?;
                (m.header, m.translation, m.rotation)
            }
            Self::Odometry => {
                let m: Odometry = decode(bytes)?;
                noise = ToldNoise::of(&m.covariance);
                (m.header, m.position, m.orientation)
            }
        };
        Ok(StampedPose {
            header,
            position,
            orientation,
            noise,
        })
    }
}
