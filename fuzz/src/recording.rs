//! MCAP files as they are.

#![no_main]

use std::ops::ControlFlow;

use libfuzzer_sys::fuzz_target;
use stickslip_formats::{
    BagOptions, CameraTopics, McapError, read_bag, read_bag_camera_info, read_bag_images,
    read_bag_info,
};

fuzz_target!(|bytes: &[u8]| {
    let file = || [("f".to_owned(), bytes)];
    let _ = read_bag_info(file());
    let _ = read_bag(file(), &BagOptions::default());
    let mapping = "image=/cam/image".parse().expect("a mapping");
    let topics = CameraTopics::new([mapping]).expect("topics");
    let _ = read_bag_camera_info(file(), &topics);
    let _ = read_bag_images(file(), &topics, &mut |_| {
        Ok::<_, McapError>(ControlFlow::Continue(()))
    });
});
