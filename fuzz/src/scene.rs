//! `scene.toml` and the small TOML files of the camera.

#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_formats::{read_mounts, read_scene, scene_assumptions};

fuzz_target!(|text: &str| {
    if read_scene(text, "f").is_ok() {
        let _ = scene_assumptions(text, "f");
    }
    let _ = read_mounts(text, "f");
    let _ = stickslip_vision::read_camera(text, "f");
    let _ = stickslip_vision::read_lens(text, "f");
    let _ = stickslip_vision::read_tags(text, "f");
    let _ = stickslip_vision::read_board(text, "f");
});
