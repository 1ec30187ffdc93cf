//! Lines of JSON, facts of a truth, metadata of a bag.

#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_formats::{read_bag_metadata, read_row_json, read_truth_json};

fuzz_target!(|text: &str| {
    let _ = read_row_json(text);
    let _ = read_truth_json(text, "f");
    let _ = read_bag_metadata(text, "f");
});
