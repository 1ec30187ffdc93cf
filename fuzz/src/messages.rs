//! Messages of any bytes in recordings that are whole: the first byte says of which type, the
//! second how long the first of two messages is.

#![no_main]

use std::collections::BTreeMap;
use std::io::Cursor;
use std::ops::ControlFlow;

use libfuzzer_sys::fuzz_target;
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use stickslip_formats::{
    BagOptions, CameraTopics, McapError, Topics, read_bag, read_bag_camera_info, read_bag_images,
    read_bag_info,
};

/// Types, and a topic where such messages are read.
const KINDS: [(&str, &str); 10] = [
    ("/object/pose", "geometry_msgs/msg/PoseStamped"),
    ("/object/pose", "geometry_msgs/msg/PoseWithCovarianceStamped"),
    ("/object/pose", "geometry_msgs/msg/TransformStamped"),
    ("/object/pose", "nav_msgs/msg/Odometry"),
    ("/pusher/wrench", "geometry_msgs/msg/WrenchStamped"),
    ("/fixel_1/contact", "std_msgs/msg/Bool"),
    ("/tf", "tf2_msgs/msg/TFMessage"),
    ("/cam/image", "sensor_msgs/msg/Image"),
    ("/cam/image", "sensor_msgs/msg/CompressedImage"),
    ("/cam/camera_info", "sensor_msgs/msg/CameraInfo"),
];

/// A recording of two messages of a type, with one of a pusher's pose for the log to have a row.
fn recording((topic, kind): (&str, &str), messages: [&[u8]; 2]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().profile("ros2").compression(None);
    let mut writer = options.create(&mut bytes).expect("a writer");
    let mut pusher = vec![0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, b'w', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    pusher.extend([0.0_f64, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|n| n.to_le_bytes()));
    for (topic, kind, data) in [
        (topic, kind, messages[0]),
        (topic, kind, messages[1]),
        ("/pusher/pose", "geometry_msgs/msg/PoseStamped", &pusher[..]),
    ] {
        let schema = writer.add_schema(kind, "ros2msg", b"").expect("a schema");
        let channel = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel");
        let header = MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 5,
            publish_time: 5,
        };
        writer.write_to_known_channel(&header, data).expect("memory takes everything");
    }
    writer.finish().expect("memory takes everything");
    drop(writer);
    bytes.into_inner()
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&[kind, split], rest)) = bytes.split_first_chunk() else {
        return;
    };
    let (first, second) = rest.split_at(usize::from(split).min(rest.len()));
    let bytes = recording(KINDS[usize::from(kind) % KINDS.len()], [first, second]);
    let file = || [("f".to_owned(), &bytes[..])];
    let _ = read_bag_info(file());
    let _ = read_bag(file(), &BagOptions::default());
    let frames = "object=/tf:a.b".parse().expect("a mapping");
    let options = BagOptions {
        topics: Topics::new([frames]).expect("topics"),
        ..BagOptions::default()
    };
    let _ = read_bag(file(), &options);
    let image = "image=/cam/image".parse().expect("a mapping");
    let topics = CameraTopics::new([image]).expect("topics");
    let _ = read_bag_camera_info(file(), &topics);
    let _ = read_bag_images(file(), &topics, &mut |_| {
        Ok::<_, McapError>(ControlFlow::Continue(()))
    });
});
