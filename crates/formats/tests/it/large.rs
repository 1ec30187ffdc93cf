//! Large inputs are read in a time and a memory that grow with them, and no faster.

use std::io::{self, Read};

use crate::bag::{Line, MS, file_with, object, pusher};

use stickslip_formats::{Topics, read_log, read_log_mcap};

/// With work that grows with the square of the columns this takes minutes.
#[test]
fn a_log_of_very_many_columns_is_read() {
    let count = 200_000;
    let required = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta";
    let sensors: Vec<String> = (1..=count).map(|k| format!("tactile_{k}")).collect();
    let others: Vec<String> = (1..=count).map(|k| format!("other_{k}")).collect();
    let cells = vec!["1"; 2 * count].join(",");
    let text = format!(
        "{required},{},{}\n0,0,0,0,0,0,0,{cells}\n",
        sensors.join(","),
        others.join(",")
    );
    let (log, warnings) = read_log(text.as_bytes(), "log.csv").unwrap();
    assert_eq!((log.tactile.len(), warnings.len()), (count, 1));
}

/// A file that notes how much is asked of it at once.
struct Watched<R> {
    file: R,
    most: usize,
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.most = self.most.max(buffer.len());
        self.file.read(buffer)
    }
}

/// Poses with camera images of `size` bytes between them.
fn with_images(count: i64, size: usize) -> Vec<u8> {
    let image = |log_time: i64| Line {
        topic: "/camera".to_owned(),
        kind: "geometry_msgs/msg/PoseStamped",
        encoding: "cdr",
        log_time,
        data: vec![0; size],
    };
    let frames = (0..count).map(|k| 30 * k * MS);
    let lines = frames.flat_map(|t| [object(t, 0.0), pusher(t, 0.0), image(t)]);
    file_with(&lines.collect::<Vec<_>>(), None, 4 << 20)
}

#[test]
fn a_recording_is_read_piece_by_piece() {
    let bytes = with_images(40, 1 << 20);
    let mut file = Watched {
        file: &bytes[..],
        most: 0,
    };
    let (log, warnings) = read_log_mcap(&mut file, "bag.mcap", &Topics::default()).unwrap();
    // the images' topic is not read
    assert_eq!((log.len(), warnings.len()), (40, 1));
    assert!(file.most <= 1 << 20, "{} bytes at once", file.most);
}

#[test]
fn a_message_that_is_no_pose_by_its_size_is_refused() {
    let topics = Topics::new(["object=/camera".parse().unwrap()]).unwrap();
    let error = read_log_mcap(&with_images(1, 1 << 20)[..], "bag.mcap", &topics);
    let text = error.unwrap_err().to_string();
    assert!(
        text.contains("a message on `/camera` has 1048576 bytes"),
        "{text}"
    );
}

#[test]
fn a_file_that_cannot_be_read_says_so() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::other("the disk is gone"))
        }
    }
    let begins = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];
    for error in [
        read_log_mcap(Broken, "bag.mcap", &Topics::default()).unwrap_err(),
        read_log_mcap((&begins[..]).chain(Broken), "bag.mcap", &Topics::default()).unwrap_err(),
    ] {
        assert!(error.to_string().contains("the disk is gone"), "{error}");
    }
}
