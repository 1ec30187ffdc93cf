//! Images of a bag, their CameraInfo, and the readings of sensors meanwhile.

use std::ops::ControlFlow;

use crate::bag::{
    Line, MS, Order, camera_info, compressed_image, file, file_with, object, raw_image, touch,
    wrench,
};
use allocation_counter::measure;
use mcap::Compression;
use proptest::prelude::*;
use stickslip_formats::{
    BagImage, BagPicture, CameraRecording, CameraTopics, McapError, read_bag_camera_info,
    read_bag_images, read_bag_info,
};

fn topics(mappings: &[&str]) -> CameraTopics {
    CameraTopics::new(mappings.iter().map(|text| text.parse().unwrap())).unwrap()
}

/// All images of a file, and the data that came with them.
fn images(
    bytes: &[u8],
    topics: &CameraTopics,
) -> Result<(Vec<BagImage>, CameraRecording), McapError> {
    let mut images = Vec::new();
    let recording = read_bag_images([("f".to_owned(), bytes)], topics, &mut |image| {
        images.push(image);
        Ok::<_, McapError>(ControlFlow::Continue(()))
    })?;
    Ok((images, recording))
}

#[track_caller]
fn refused(lines: &[Line], mappings: &[&str], words: &str) {
    let text = images(&file(lines), &topics(mappings))
        .unwrap_err()
        .to_string();
    assert!(text.starts_with("f: ") && text.contains(words), "{text}");
}

#[test]
fn images_are_shown_as_they_were_recorded() {
    let lines = [
        raw_image("/cam/image", 2 * MS, "mono8", &[1, 2, 3, 0, 0, 4, 5, 6]),
        raw_image("/other/image", MS, "mono8", &[9; 8]),
        raw_image("/cam/image", MS, "bgr8", &[7; 3]),
    ];
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let bytes = file_with(&lines, compression, 100);
        let (found, _) = images(&bytes, &topics(&["image=/cam/image"])).unwrap();
        let raw = |encoding: &str, bytes: &[u8]| BagPicture::Raw {
            size: [3, 2],
            encoding: encoding.to_owned(),
            step: 5,
            is_big_endian: false,
            bytes: bytes.to_vec(),
        };
        let expected = [
            (
                2 * MS,
                "f: /cam/image, message 1",
                raw("mono8", &[1, 2, 3, 0, 0, 4, 5, 6]),
            ),
            (MS, "f: /cam/image, message 2", raw("bgr8", &[7; 3])),
        ];
        assert_eq!(found.len(), 2);
        for (image, (stamp, name, picture)) in found.into_iter().zip(expected) {
            assert_eq!((image.stamp, image.name.as_str()), (stamp, name));
            assert_eq!(image.picture, picture);
        }
    }
}

#[test]
fn compressed_images_are_read_in_both_byte_orders() {
    for order in [Order::Little, Order::Big] {
        let lines = [compressed_image(
            "/image",
            order,
            5 * MS,
            b"\xff\xd8 a file",
        )];
        let (found, _) = images(&file(&lines), &topics(&["image=/image"])).unwrap();
        let picture = BagPicture::Compressed {
            format: "jpeg".to_owned(),
            bytes: b"\xff\xd8 a file".to_vec(),
        };
        assert_eq!((found[0].stamp, &found[0].picture), (5 * MS, &picture));
    }
}

#[test]
fn reading_stops_where_enough_was_seen() {
    let lines: Vec<Line> = (0..9)
        .map(|k| raw_image("/image", k * MS, "mono8", &[0; 8]))
        .collect();
    let mut seen = 0;
    let read = read_bag_images(
        [("f".to_owned(), &file(&lines)[..])],
        &topics(&["image=/image"]),
        &mut |_| {
            seen += 1;
            Ok::<_, McapError>(if seen == 4 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        },
    );
    assert_eq!((read.unwrap().damage().len(), seen), (0, 4));
}

#[test]
fn camera_info_is_the_first_message_beside_the_images() {
    let lines = [
        raw_image("/cam/image_raw", 0, "mono8", &[0; 8]),
        camera_info("/other/camera_info", 0, 300.0, &[]),
        camera_info(
            "/cam/camera_info",
            MS,
            600.0,
            &[-0.25, 0.5, 1e-3, -2e-3, 0.125],
        ),
    ];
    let read = |mappings: &[&str]| {
        read_bag_camera_info([("f".to_owned(), &file(&lines)[..])], &topics(mappings))
    };
    let info = read(&["image=/cam/image_raw"]).unwrap().unwrap();
    assert_eq!((info.size, info.model.as_str()), ([640, 480], "plumb_bob"));
    assert_eq!(info.distortion, [-0.25, 0.5, 1e-3, -2e-3, 0.125]);
    assert_eq!(
        info.matrix,
        [600.0, 0.0, 320.0, 0.0, 600.0, 240.0, 0.0, 0.0, 1.0]
    );
    assert_eq!((info.binning, info.window), ([1, 1], [11, 12, 14, 13]));

    let other = read(&["image=/cam/image_raw", "info=/other/camera_info"])
        .unwrap()
        .unwrap();
    assert_eq!((other.matrix[0], other.distortion.len()), (300.0, 0));
    assert_eq!(read(&["image=/cam/image_raw", "info="]).unwrap(), None);
    assert_eq!(read(&["image=/third/image_raw"]).unwrap(), None);
    let text = read(&["image=/cam/image_raw", "info=/cam/info"])
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("the topic `/cam/info` (info) is not there")
            && text.contains("has /cam/camera_info, /other/camera_info"),
        "{text}"
    );
    let text = read(&["image=/cam/image_raw", "info=/cam/image_raw"])
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("sensor_msgs/msg/CameraInfo is needed"),
        "{text}"
    );
}

#[test]
fn sensors_of_a_bag_of_images_fill_the_frames_rows() {
    let mut lines: Vec<Line> = (0..4)
        .map(|k| raw_image("/image", 100 * k * MS, "mono8", &[0; 8]))
        .collect();
    lines.extend([
        touch(1, 50 * MS, false),
        touch(1, 150 * MS, true),
        touch(1, 190 * MS, false),
    ]);
    lines.extend([
        wrench(120 * MS, 1.0, 2.0),
        wrench(180 * MS, 3.0, 4.0),
        object(0, 0.5),
    ]);
    let time = || (0..4).map(|k| 100 * k * MS).collect();
    let topics = topics(&["image=/image", "wrench=/pusher/wrench"]);
    let (_, recording) = images(&file(&lines), &topics).unwrap();
    let readings = recording.readings(&topics, time(), 0.05).unwrap();
    assert_eq!(readings.tactile, [[None, Some(false), Some(true), None]]);
    assert_eq!(readings.force, [None, None, Some([2.0, 3.0]), None]);
    assert_eq!(readings.warnings, []);

    // sensor 2 alone would be that of the first fixel
    lines.push(touch(3, 0, true));
    let (_, recording) = images(&file(&lines), &topics).unwrap();
    let text = recording
        .readings(&topics, time(), 0.05)
        .unwrap_err()
        .to_string();
    assert!(text.contains("fixel_2 is not there"), "{text}");
}

#[test]
fn info_says_how_images_are_tracked() {
    let lines = [
        raw_image("/cam/image_rect", 0, "mono8", &[0; 8]),
        raw_image("/cam/image_raw", 0, "mono8", &[0; 8]),
        camera_info("/cam/camera_info", MS, 600.0, &[]),
        touch(1, 0, true),
        raw_image("/alone/image", 0, "mono8", &[0; 8]),
        raw_image("/alone/image", MS, "mono8", &[0; 8]),
    ];
    let (info, _) = read_bag_info([("f".to_owned(), &file(&lines)[..])]).unwrap();
    assert_eq!(info.image_suggestion, ["image=/cam/image_raw"]);
    let keys: Vec<(&str, &[&str])> = info
        .topics
        .iter()
        .map(|topic| (topic.name.as_str(), &topic.keys[..]))
        .collect();
    assert!(keys.contains(&("/cam/camera_info", &["info"])), "{keys:?}");
    assert!(keys.contains(&("/alone/image", &["image"])), "{keys:?}");
}

#[test]
fn what_cannot_be_used_is_refused() {
    let image = |stamp: i64| raw_image("/image", stamp, "mono8", &[0; 8]);
    refused(
        &[object(0, 0.0)],
        &["image=/image"],
        "the topic `/image` (image) is not there. Say which topic it is with image=TOPIC; the recording has none",
    );
    refused(
        &[object(0, 0.0), image(0)],
        &["image=/object/pose"],
        "sensor_msgs/msg/Image or sensor_msgs/msg/CompressedImage is needed",
    );
    refused(
        &[image(0), image(MS), image(0)],
        &["image=/image"],
        "/image, message 3 (log time 0.003000000 s): header.stamp is 0.000000000 s, as in message 1",
    );
    let infos = [600.0, 601.0].map(|focal| camera_info("/camera_info", 0, focal, &[]));
    refused(
        &[&infos[..], &[image(0)]].concat(),
        &["image=/image"],
        "from a focal length of 600 px to 601 px",
    );
    let mut short = image(0);
    short.data.truncate(short.data.len() - 2);
    refused(
        &[short],
        &["image=/image"],
        "it says that 8 bytes follow, and 6 do",
    );
    let mut long = image(0);
    long.data.extend([0; 9]);
    refused(
        &[long],
        &["image=/image"],
        "it says that 8 bytes follow, and 17 do",
    );
    let mut json = image(0);
    json.encoding = "json";
    refused(&[json], &["image=/image"], "encoded as `json`");
}

/// A bag is read chunk by chunk: many images take no more memory than a few.
#[test]
fn images_are_not_kept() {
    let peak = |count: i64| {
        let pixels = vec![7; 60_000];
        let lines: Vec<Line> = (0..count)
            .map(|k| raw_image("/image", k * MS, "mono8", &pixels))
            .collect();
        let bytes = file_with(&lines, None, 1 << 18);
        let topics = topics(&["image=/image"]);
        let mut seen = 0;
        let used = measure(|| {
            read_bag_images([("f".to_owned(), &bytes[..])], &topics, &mut |_| {
                seen += 1;
                Ok::<_, McapError>(ControlFlow::Continue(()))
            })
            .unwrap();
        });
        assert_eq!(seen, count);
        used.bytes_max
    };
    let (few, many) = (peak(12), peak(120));
    assert!(many < few + (1 << 17), "{few} {many}");
}

proptest! {
    #[test]
    fn damaged_images_are_read_or_refused(
        which in 0..3_usize,
        at in any::<prop::sample::Index>(),
        bytes in prop::collection::vec(any::<u8>(), 0..9),
        cut in 0..9_usize,
    ) {
        let mut lines = vec![
            raw_image("/a/image", 0, "mono8", &[1; 8]),
            compressed_image("/b/image", Order::Big, 0, &[3; 30]),
            camera_info("/a/camera_info", 0, 600.0, &[0.1; 5]),
        ];
        let data = &mut lines[which].data;
        let start = at.index(data.len());
        let end = (start + cut).min(data.len());
        data.splice(start..end, bytes);
        let bytes = file(&lines);
        for image in ["image=/a/image", "image=/b/image"] {
            let topics = topics(&[image]);
            if let Err(error) = images(&bytes, &topics) {
                prop_assert!(error.to_string().starts_with("f: "), "{error}");
            }
            if let Err(error) = read_bag_camera_info([("f".to_owned(), &bytes[..])], &topics) {
                prop_assert!(error.to_string().starts_with("f: "), "{error}");
            }
        }
    }
}
