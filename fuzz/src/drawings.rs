//! Drawings of outlines, and lenses in YAML.

#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_formats::{OutlineOptions, read_dxf_outline, read_scene, read_svg_outline};
use stickslip_vision::read_camera_info;

fuzz_target!(|text: &str| {
    let options = OutlineOptions::default();
    for outline in [read_svg_outline(text, "f", &options), read_dxf_outline(text, "f", &options)] {
        if let Ok(outline) = outline.as_ref() && outline.holes == 0 {
            read_scene(&outline.scene(), "f").expect("an outline makes a scene");
        }
    }
    if let Ok(info) = read_camera_info(text, "f") {
        let _ = info.lens("f");
    }
});
