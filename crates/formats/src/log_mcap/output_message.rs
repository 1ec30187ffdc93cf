//! Messages of estimates, as viewers of ROS 2 draw them, and their definitions.

use serde::{Deserialize, Serialize};

use crate::log_mcap::message::{Header, Message, Quaternion, Vector3, WrittenMessage};
use crate::log_mcap::pose_message::{PoseWithCovarianceStamped, TfMessage};

/// `std_msgs/msg/ColorRGBA`, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Colour {
    pub r: f32,
    pub g: f32,
    pub b: f32,
    pub a: f32,
}

/// `visualization_msgs/msg/Marker`, its pose laid out flat; fields that no marker of ours uses stay
/// empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Marker {
    pub header: Header,
    pub ns: String,
    pub id: i32,
    pub kind: i32,
    pub action: i32,
    pub position: Vector3,
    pub orientation: Quaternion,
    pub scale: Vector3,
    pub colour: Colour,
    pub lifetime: (i32, u32),
    pub frame_locked: bool,
    pub points: Vec<Vector3>,
    pub colours: Vec<Colour>,
    pub texture_resource: String,
    pub texture: (Header, String, Vec<u8>),
    pub uv_coordinates: Vec<(f32, f32)>,
    pub text: String,
    pub mesh_resource: String,
    pub mesh_file: (String, Vec<u8>),
    pub mesh_use_embedded_materials: bool,
}

/// `visualization_msgs/msg/MarkerArray`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MarkerArray {
    pub markers: Vec<Marker>,
}

/// `geometry_msgs/msg/PoseArray`, its poses laid out flat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseArray {
    pub header: Header,
    pub poses: Vec<(Vector3, Quaternion)>,
}

/// `sensor_msgs/msg/PointField`: name, offset (bytes), type of its numbers and how many.
pub(crate) type PointField = (String, u32, u8, u32);

/// `sensor_msgs/msg/PointCloud2`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PointCloud {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub fields: Vec<PointField>,
    pub is_bigendian: bool,
    pub point_step: u32,
    pub row_step: u32,
    pub data: Vec<u8>,
    pub is_dense: bool,
}

impl PointCloud {
    /// Points on the table (m), as x, y and z in single precision.
    pub(crate) fn new(header: Header, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let bytes = |[x, y]: [f64; 2]| [x as f32, y as f32, 0.0].map(f32::to_le_bytes);
        let data: Vec<u8> = points.into_iter().flat_map(bytes).flatten().collect();
        let (float, step) = (7, 12);
        let row_step = data.len() as u32;
        let field = |(name, offset): (&str, u32)| (name.to_owned(), offset, float, 1);
        Self {
            header,
            height: 1,
            width: row_step / step,
            fields: [("x", 0), ("y", 4), ("z", 8)].map(field).to_vec(),
            is_bigendian: false,
            point_step: step,
            row_step,
            data,
            is_dense: true,
        }
    }
}

/// `std_msgs/msg/Float64`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Float64 {
    pub data: f64,
}

/// A line from point to point.
pub(crate) const LINE_STRIP: i32 = 4;
/// Actions on a marker: draw it again, take it away.
pub(crate) const ADD: i32 = 0;
pub(crate) const DELETE: i32 = 2;

macro_rules! definitions {
    ($first:literal $(, $name:literal: $body:literal)*) => {
        concat!(
            $first
            $(, "================================================================================\nMSG: ", $name, "\n", $body)*
        )
    };
}

impl Message for MarkerArray {
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
}

impl Message for PoseArray {
    const TYPE: &'static str = "geometry_msgs/msg/PoseArray";
}

impl WrittenMessage for PoseArray {
    const SCHEMA: &'static str = definitions!(
        "std_msgs/Header header\ngeometry_msgs/Pose[] poses\n",
        "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
        "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
        "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
        "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    );
}

impl Message for PointCloud {
    const TYPE: &'static str = "sensor_msgs/msg/PointCloud2";
}

impl WrittenMessage for PointCloud {
    const SCHEMA: &'static str = definitions!(
        "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
        "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
        "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
        "sensor_msgs/PointField": "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"
    );
}

impl Message for Float64 {
    const TYPE: &'static str = "std_msgs/msg/Float64";
}

impl WrittenMessage for Float64 {
    const SCHEMA: &'static str = "float64 data\n";
}

impl WrittenMessage for PoseWithCovarianceStamped {
    const SCHEMA: &'static str = definitions!(
        "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
        "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
        "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
        "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
        "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
        "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    );
}

impl WrittenMessage for TfMessage {
    const SCHEMA: &'static str = definitions!(
        "geometry_msgs/TransformStamped[] transforms\n",
        "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
        "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
        "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
        "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
        "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
        "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    );
}

impl WrittenMessage for MarkerArray {
    const SCHEMA: &'static str = definitions!(
        "visualization_msgs/Marker[] markers\n",
        "visualization_msgs/Marker": "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\nint32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\nint32 TRIANGLE_LIST=11\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
        "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
        "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
        "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
        "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
        "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
        "std_msgs/ColorRGBA": "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
        "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec\n",
        "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data\n",
        "visualization_msgs/UVCoordinate": "float32 u\nfloat32 v\n",
        "visualization_msgs/MeshFile": "string filename\nuint8[] data\n"
    );
}
