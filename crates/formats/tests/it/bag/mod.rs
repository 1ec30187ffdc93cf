//! Recordings built by hand: messages laid out byte by byte after the CDR specification, without
//! the crate's own types.
use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use stickslip::Log;
use stickslip_dynamics::Pose;
use stickslip_formats::{LogWarning, Topics, read_log_mcap};

/// Milliseconds in nanoseconds.
pub const MS: i64 = 1_000_000;

pub const POSE: &str = "geometry_msgs/msg/PoseStamped";
pub const WRENCH: &str = "geometry_msgs/msg/WrenchStamped";
pub const TF: &str = "tf2_msgs/msg/TFMessage";
pub const BOOL: &str = "std_msgs/msg/Bool";
pub const IMAGE: &str = "sensor_msgs/msg/Image";
pub const COMPRESSED: &str = "sensor_msgs/msg/CompressedImage";
pub const INFO: &str = "sensor_msgs/msg/CameraInfo";

/// One message.
#[derive(Clone)]
pub struct Line {
    pub topic: String,
    pub kind: &'static str,
    pub encoding: &'static str,
    pub log_time: i64,
    pub data: Vec<u8>,
}

/// Byte order of a message.
#[derive(Clone, Copy, PartialEq)]
pub enum Order {
    Little,
    Big,
}

/// CDR in the making.
struct Cdr {
    bytes: Vec<u8>,
    order: Order,
}

impl Cdr {
    fn new(order: Order) -> Self {
        Self {
            bytes: vec![0, u8::from(order == Order::Little), 0, 0],
            order,
        }
    }

    fn number<const N: usize>(&mut self, little: [u8; N]) {
        while !(self.bytes.len() - 4).is_multiple_of(N) {
            self.bytes.push(0);
        }
        let mut bytes = little;
        if self.order == Order::Big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }

    fn header(&mut self, stamp: i64, frame: &str) {
        self.number(
            i32::try_from(stamp.div_euclid(1_000_000_000))
                .unwrap()
                .to_le_bytes(),
        );
        self.number(
            u32::try_from(stamp.rem_euclid(1_000_000_000))
                .unwrap()
                .to_le_bytes(),
        );
        self.text(frame);
    }

    fn text(&mut self, text: &str) {
        self.number(u32::try_from(text.len() + 1).unwrap().to_le_bytes());
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }
}

/// An image of 3 x 2 grey levels with two spare bytes a row, on a topic; its log time is 3 ms late.
pub fn raw_image(topic: &str, stamp: i64, encoding: &str, bytes: &[u8]) -> Line {
    let mut cdr = Cdr::new(Order::Little);
    cdr.header(stamp, "camera");
    for number in [2_u32, 3] {
        cdr.number(number.to_le_bytes());
    }
    cdr.text(encoding);
    cdr.number([0_u8]);
    cdr.number(5_u32.to_le_bytes());
    cdr.number(u32::try_from(bytes.len()).unwrap().to_le_bytes());
    cdr.bytes.extend(bytes);
    Line {
        topic: topic.to_owned(),
        kind: IMAGE,
        encoding: "cdr",
        log_time: (stamp + 3 * MS).max(0),
        data: cdr.bytes,
    }
}

/// A compressed image in either byte order.
pub fn compressed_image(topic: &str, order: Order, stamp: i64, bytes: &[u8]) -> Line {
    let mut cdr = Cdr::new(order);
    cdr.header(stamp, "camera");
    cdr.text("jpeg");
    cdr.number(u32::try_from(bytes.len()).unwrap().to_le_bytes());
    cdr.bytes.extend(bytes);
    Line {
        kind: COMPRESSED,
        data: cdr.bytes,
        ..raw_image(topic, stamp, "mono8", &[])
    }
}

/// CameraInfo of 640 x 480 pixels with a focal length and these numbers of plumb_bob.
pub fn camera_info(topic: &str, stamp: i64, focal: f64, distortion: &[f64]) -> Line {
    let mut cdr = Cdr::new(Order::Little);
    cdr.header(stamp, "camera");
    for number in [480_u32, 640] {
        cdr.number(number.to_le_bytes());
    }
    cdr.text("plumb_bob");
    cdr.number(u32::try_from(distortion.len()).unwrap().to_le_bytes());
    let k = [focal, 0.0, 320.0, 0.0, focal, 240.0, 0.0, 0.0, 1.0];
    for number in distortion.iter().chain(&k).chain(&[7.0; 9 + 12]) {
        cdr.number(number.to_le_bytes());
    }
    for number in [1_u32, 1, 11, 12, 13, 14] {
        cdr.number(number.to_le_bytes());
    }
    cdr.number([0_u8]);
    Line {
        kind: INFO,
        data: cdr.bytes,
        ..raw_image(topic, stamp, "mono8", &[])
    }
}

/// A transform: stamp, parent, child, translation and quaternion (x, y, z, w).
pub type Transform<'a> = (i64, &'a str, &'a str, [f64; 7]);

/// A line with transforms on `/tf` or `/tf_static`, 3 ms late.
pub fn transforms(topic: &str, transforms: &[Transform<'_>]) -> Line {
    let mut cdr = Cdr::new(Order::Little);
    cdr.number(u32::try_from(transforms.len()).unwrap().to_le_bytes());
    for (stamp, parent, child, numbers) in transforms {
        cdr.header(*stamp, parent);
        cdr.text(child);
        for number in numbers {
            cdr.number(number.to_le_bytes());
        }
    }
    let latest = transforms.iter().map(|transform| transform.0).max();
    Line {
        topic: topic.to_owned(),
        kind: TF,
        encoding: "cdr",
        log_time: (latest.unwrap_or(0) + 3 * MS).max(0),
        data: cdr.bytes,
    }
}

/// A line with a pose at (x, 0) of a type that says more than its pose: `extra` numbers follow, and
/// a text comes before it where `child` is one.
pub fn longer(kind: &'static str, stamp: i64, x: f64, child: Option<&str>, extra: usize) -> Line {
    let mut cdr = Cdr::new(Order::Little);
    cdr.header(stamp, "world");
    child.into_iter().for_each(|child| cdr.text(child));
    for number in [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0] {
        cdr.number(number.to_le_bytes());
    }
    (0..extra).for_each(|k| cdr.number(told(k / 6 % 6, k % 6).to_le_bytes()));
    Line {
        kind,
        data: cdr.bytes,
        ..object(stamp, x)
    }
}

/// An entry of the covariance in such a line, of x, y, z and turns about the axes.
pub fn told(i: usize, j: usize) -> f64 {
    match i == j {
        true => 0.25 * (1 + i) as f64,
        false => 0.0625 / (1 + i + j) as f64,
    }
}

/// A stamped message of numbers: a pose (position, quaternion) or a wrench (force, torque).
pub fn stamped(order: Order, stamp: i64, frame: &str, numbers: &[f64]) -> Vec<u8> {
    let mut cdr = Cdr::new(order);
    cdr.header(stamp, frame);
    for number in numbers {
        cdr.number(number.to_le_bytes());
    }
    cdr.bytes
}

/// A line with a pose at (x, 0) whose quaternion is given as (x, y, z, w); its log time is 3 ms
/// late, as on a real machine.
pub fn quaternion(topic: &str, stamp: i64, x: f64, q: [f64; 4]) -> Line {
    let data = stamped(
        Order::Little,
        stamp,
        "world",
        &[x, 0.0, 0.0, q[0], q[1], q[2], q[3]],
    );
    Line {
        topic: topic.to_owned(),
        kind: POSE,
        encoding: "cdr",
        log_time: (stamp + 3 * MS).max(0),
        data,
    }
}

/// A line with a pose at (x, 0) and the angle 0.
pub fn pose(topic: &str, stamp: i64, x: f64) -> Line {
    quaternion(topic, stamp, x, [0.0, 0.0, 0.0, 1.0])
}

pub fn object(stamp: i64, x: f64) -> Line {
    pose("/object/pose", stamp, x)
}

pub fn pusher(stamp: i64, x: f64) -> Line {
    pose("/pusher/pose", stamp, x)
}

pub fn touch(fixel: usize, log_time: i64, on: bool) -> Line {
    Line {
        topic: format!("/fixel_{fixel}/contact"),
        kind: BOOL,
        encoding: "cdr",
        log_time,
        data: vec![0, 1, 0, 0, u8::from(on)],
    }
}

pub fn wrench(stamp: i64, x: f64, y: f64) -> Line {
    let data = stamped(Order::Little, stamp, "world", &[x, y, 9.0, 7.0, 7.0, 7.0]);
    Line {
        topic: "/pusher/wrench".to_owned(),
        kind: WRENCH,
        encoding: "cdr",
        log_time: stamp + 3 * MS,
        data,
    }
}

/// The file, in chunks of at most `chunk` bytes.
pub fn file_with(lines: &[Line], compression: Option<Compression>, chunk: u64) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new()
        .profile("ros2")
        .compression(compression)
        .chunk_size(Some(chunk))
        .compression_threads(0);
    let mut writer = options.create(&mut bytes).unwrap();
    for line in lines {
        let schema = writer
            .add_schema(line.kind, "ros2msg", b"not looked at")
            .unwrap();
        let channel_id = writer
            .add_channel(schema, &line.topic, line.encoding, &BTreeMap::new())
            .unwrap();
        let log_time = u64::try_from(line.log_time).unwrap();
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, &line.data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

pub fn file(lines: &[Line]) -> Vec<u8> {
    file_with(lines, None, 1 << 20)
}

pub fn topics(mappings: &[&str]) -> Topics {
    Topics::new(mappings.iter().map(|text| text.parse().unwrap())).unwrap()
}

#[track_caller]
pub fn read(bytes: &[u8]) -> (Log, Vec<LogWarning>) {
    read_log_mcap(bytes, "bag.mcap", &Topics::default()).unwrap_or_else(|error| panic!("{error}"))
}

pub fn xs(poses: &[Option<Pose>]) -> Vec<Option<f64>> {
    poses.iter().map(|pose| pose.map(|pose| pose.x)).collect()
}
