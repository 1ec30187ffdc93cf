//! Damaged bags never bring a reader down: metadata, messages with transforms, lines of JSON.

use crate::bag::{MS, file, longer, pusher, topics, transforms};
use proptest::prelude::*;
use stickslip_formats::{BagOptions, read_bag, read_bag_info, read_bag_metadata, read_row_json};

const METADATA: &str = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 5\n  relative_file_paths:\n    - a_0.mcap\n    - a_1.mcap\n";
const ROW: &str =
    r#"{"time": 0.5, "object_x": 1e-3, "object_y": -0, "object_theta": null, "tactile_1": true}"#;

/// A text with a piece cut out and another one put in.
fn damaged(good: &str, at: prop::sample::Index, cut: usize, insert: &str) -> String {
    let start = at.index(good.len());
    format!(
        "{}{insert}{}",
        &good[..start],
        good.get(start + cut..).unwrap_or("")
    )
}

proptest! {
    #[test]
    fn damaged_metadata_and_rows_are_read_or_refused(
        at in any::<prop::sample::Index>(),
        cut in 0..20_usize,
        insert in "[0-9a-z .:&*!{}\\[\\]\"\n-]{0,8}",
    ) {
        if let Err(error) = read_bag_metadata(&damaged(METADATA, at, cut, &insert), "f") {
            prop_assert!(error.to_string().starts_with("f: "), "{error}");
        }
        let _ = read_row_json(&damaged(ROW, at, cut, &insert));
    }

    #[test]
    fn damaged_messages_are_read_or_refused(
        which in 0..3_usize,
        at in any::<prop::sample::Index>(),
        bytes in prop::collection::vec(any::<u8>(), 0..9),
        cut in 0..9_usize,
    ) {
        let up = [0.1, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0];
        let tf = transforms("/tf", &[(MS, "table", "tag", up), (MS, "tag", "box", up)]);
        let odometry = longer("nav_msgs/msg/Odometry", MS, 1.0, Some("box"), 78);
        let fixed = transforms("/tf_static", &[(0, "map", "table", up)]);
        let mut lines = vec![tf, odometry, fixed, pusher(0, 0.0)];
        let data = &mut lines[which].data;
        let start = at.index(data.len());
        let end = (start + cut).min(data.len());
        data.splice(start..end, bytes);
        let bytes = file(&lines);
        for mappings in [&["object=/tf:map.box"][..], &[]] {
            let options = BagOptions { topics: topics(mappings), ..BagOptions::default() };
            if let Err(error) = read_bag([("f".to_owned(), &bytes[..])], &options) {
                prop_assert!(error.to_string().starts_with("f: "), "{error}");
            }
        }
        prop_assert!(read_bag_info([("f".to_owned(), &bytes[..])]).is_ok());
    }
}

#[test]
fn texts_that_unfold_to_gigabytes_are_refused() {
    let mut yaml = "a: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_owned();
    for k in 1..12 {
        let before = format!("*a{}", k - 1);
        yaml += &format!("b{k}: &a{k} [{}]\n", vec![before; 10].join(", "));
    }
    yaml += "rosbag2_bagfile_information: *a11\n";
    let message = read_bag_metadata(&yaml, "f").unwrap_err().to_string();
    assert!(
        message.starts_with("f: this is no metadata of a bag: "),
        "{message}"
    );
    let deep = format!("rosbag2_bagfile_information: {}", "[".repeat(100_000));
    assert!(read_bag_metadata(&deep, "f").is_err());
    let long = "x".repeat((1 << 24) + 1);
    let message = read_bag_metadata(&long, "f").unwrap_err().to_string();
    assert!(
        message.starts_with("f: the file has 16777217 bytes; at most 16777216 are read"),
        "{message}"
    );
    assert!(read_row_json(&"[".repeat(60_000)).is_err());
}

#[test]
fn count_of_transforms_that_lies_is_refused() {
    let mut line = transforms("/tf", &[]);
    line.data = [&[0, 1, 0, 0][..], &u32::MAX.to_le_bytes()].concat();
    let bytes = file(&[line, pusher(0, 0.0)]);
    let options = BagOptions {
        topics: topics(&["object=/tf:map.box"]),
        ..BagOptions::default()
    };
    let message = read_bag([("f".to_owned(), &bytes[..])], &options)
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("the message is no tf2_msgs/msg/TFMessage: "),
        "{message}"
    );
}
