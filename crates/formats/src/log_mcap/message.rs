//! The ROS 2 messages of a log in CDR, and their definitions as recorders write them.

use byteorder::{BigEndian, LittleEndian};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::log_mcap::error::McapProblem;

/// Nanoseconds in a second.
pub(crate) const SECOND: i64 = 1_000_000_000;

/// Bytes that a message may be longer than its type: padding by writers.
pub(crate) const PADDING: usize = 8;

/// A ROS 2 message type.
pub(crate) trait Message: DeserializeOwned {
    /// Name of the type.
    const TYPE: &'static str;
}

/// One that is written.
pub(crate) trait WrittenMessage: Message + Serialize {
    /// Its definition with those of the types in it, in `ros2msg`.
    const SCHEMA: &'static str;
}

/// `std_msgs/msg/Bool`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bool {
    pub data: bool,
}

/// `builtin_interfaces/msg/Time`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// `geometry_msgs/msg/Point` and `geometry_msgs/msg/Vector3`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/msg/Quaternion`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// `geometry_msgs/msg/PoseStamped`, its pose laid out flat: CDR is the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseStamped {
    pub header: Header,
    pub position: Vector3,
    pub orientation: Quaternion,
}

/// `geometry_msgs/msg/WrenchStamped`, its wrench laid out flat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WrenchStamped {
    pub header: Header,
    pub force: Vector3,
    pub torque: Vector3,
}

macro_rules! separator {
    () => {
        "================================================================================\n"
    };
}

macro_rules! header {
    () => {
        concat!(
            separator!(),
            "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
            separator!(),
            "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        )
    };
}

impl Message for Bool {
    const TYPE: &'static str = "std_msgs/msg/Bool";
}

impl WrittenMessage for Bool {
    const SCHEMA: &'static str = "bool data\n";
}

impl Message for PoseStamped {
    const TYPE: &'static str = "geometry_msgs/msg/PoseStamped";
}

impl WrittenMessage for PoseStamped {
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
        header!(),
        separator!(),
        "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        separator!(),
        "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n",
        separator!(),
        "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
    );
}

impl Message for WrenchStamped {
    const TYPE: &'static str = "geometry_msgs/msg/WrenchStamped";
}

impl WrittenMessage for WrenchStamped {
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
        header!(),
        separator!(),
        "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
        separator!(),
        "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    );
}

impl Time {
    /// A time (ns) as a stamp, if one can hold it.
    pub(crate) fn of(nanoseconds: i64) -> Option<Self> {
        let sec = i32::try_from(nanoseconds.div_euclid(SECOND)).ok()?;
        let nanosec = u32::try_from(nanoseconds.rem_euclid(SECOND)).ok()?;
        Some(Self { sec, nanosec })
    }

    /// The time (ns).
    pub(crate) fn nanoseconds(&self) -> i64 {
        i64::from(self.sec) * SECOND + i64::from(self.nanosec)
    }
}

/// A message as little-endian CDR, behind the four bytes that say so.
pub(crate) fn encode<M: WrittenMessage>(message: &M) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<M, LittleEndian>(message);
    // numbers, flags and strings have one encoding each, and a vector takes any length
    let Ok(body) = body else {
        panic!("a message of {} has a CDR form", M::TYPE)
    };
    [&[0, 1, 0, 0], body.as_slice()].concat()
}

/// A message from little- or big-endian CDR.
pub(crate) fn decode<M: Message>(bytes: &[u8]) -> Result<M, McapProblem> {
    match decode_front(bytes)? {
        (message, rest) if rest.len() < PADDING => Ok(message),
        (_, rest) => Err(wrong::<M>(format!("{} bytes are left over", rest.len()))),
    }
}

/// Decodes the beginning of a message, and returns it with the bytes that follow.
pub(crate) fn decode_front<M: Message>(bytes: &[u8]) -> Result<(M, &[u8]), McapProblem> {
    let Some((&[first, second, _, _], body)) = bytes.split_first_chunk() else {
        return Err(wrong::<M>(format!(
            "it has {} bytes and CDR begins with four of its own",
            bytes.len()
        )));
    };
    let read = match (first, second) {
        (0, 0) => cdr_encoding::from_bytes::<M, BigEndian>(body),
        (0, 1) => cdr_encoding::from_bytes::<M, LittleEndian>(body),
        _ => {
            return Err(McapProblem::Encapsulation {
                found: [first, second],
            });
        }
    };
    let (message, used) = read.map_err(|error| wrong::<M>(error.to_string()))?;
    Ok((message, body.get(used..).unwrap_or_default()))
}

fn wrong<M: Message>(why: String) -> McapProblem {
    McapProblem::Message {
        expected: M::TYPE,
        why,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encode_lays_a_pose_out_as_the_specification_says() {
        let header = Header {
            stamp: Time { sec: 2, nanosec: 5 },
            frame_id: "world".to_owned(),
        };
        let position = Vector3 {
            x: 1.0,
            y: 2.0,
            z: 0.0,
        };
        let pose = PoseStamped {
            header,
            position,
            orientation: Quaternion {
                x: 0.0,
                y: 0.0,
                z: 0.0,
                w: 1.0,
            },
        };
        let bytes = encode(&pose);
        // stamp, length with the closing zero, text, two bytes to the next multiple of 8, numbers
        let front = [
            0, 1, 0, 0, 2, 0, 0, 0, 5, 0, 0, 0, 6, 0, 0, 0, b'w', b'o', b'r', b'l', b'd', 0, 0, 0,
        ];
        assert_eq!(bytes[..24], front);
        let numbers: Vec<f64> = bytes[28..]
            .chunks(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(
            (bytes[24..28].to_vec(), numbers),
            (vec![0; 4], vec![1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        );
        assert_eq!(decode::<PoseStamped>(&bytes), Ok(pose));
    }

    #[test]
    fn decode_reads_both_byte_orders_and_padding() {
        for bytes in [
            &[0, 0, 0, 0, 1][..],
            &[0, 1, 0, 0, 1],
            &[0, 1, 0, 3, 1, 0, 0, 0],
        ] {
            assert_eq!(decode::<Bool>(bytes), Ok(Bool { data: true }));
        }
    }

    #[test]
    fn decode_refuses_with_words() {
        for (bytes, words) in [
            (&[0, 1][..], "it has 2 bytes"),
            (&[0, 1, 0, 0], "std_msgs/msg/Bool"),
            (&[0, 1, 0, 0, 2], "std_msgs/msg/Bool"),
            (&[0x28, 0xb5, 0x2f, 0xfd, 1], "28 B5"),
            (
                &[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0],
                "8 bytes are left over",
            ),
        ] {
            let message = decode::<Bool>(bytes).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    #[test]
    fn stamps_hold_what_32_bits_hold() {
        assert_eq!(Time::of(2 * SECOND + 5), Some(Time { sec: 2, nanosec: 5 }));
        assert_eq!(Time::of(-1).unwrap().nanoseconds(), -1);
        assert_eq!(Time::of((i64::from(i32::MAX) + 1) * SECOND), None);
    }
}
