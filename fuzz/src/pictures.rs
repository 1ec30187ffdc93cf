//! Images: files, and rows of pixels whose size and encoding the first bytes say.

#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_vision::{RawPicture, read_compressed, read_picture};

const ENCODINGS: [&str; 8] =
    ["mono8", "mono16", "rgb8", "bgra8", "bayer_rggb8", "yuv422", "16UC1", "rgba8"];

fuzz_target!(|bytes: &[u8]| {
    let _ = read_picture(bytes, "f");
    let _ = read_compressed(bytes, "jpeg", "f");
    if let Some((&[encoding, width, height, step], rest)) = bytes.split_first_chunk() {
        let raw = RawPicture {
            size: [width.into(), height.into()],
            encoding: ENCODINGS[usize::from(encoding) % ENCODINGS.len()].to_owned(),
            step: step.into(),
            is_big_endian: encoding > 127,
            bytes: rest.to_vec(),
        };
        if let Ok(grey) = raw.grey("f") {
            assert_eq!(grey.dimensions(), (width.into(), height.into()));
        }
    }
});
