//! Arbitrary bytes never bring a reader down: it reads or refuses.

use proptest::prelude::*;
use stickslip_formats::{
    read_estimate, read_frames, read_log, read_scene, read_truth_csv, read_truth_json,
};

const SCENE: &str = include_str!("full_scene.toml");
const LOG: &str = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta,tactile_1\n0,1,2,3,4,5,6,0\n0.5,,,,4,5,6,\n";
const JSON: &str =
    r#"{ "mu_s": 0.16, "first_fixel_contacts": [310, null], "final_pose": [0.5, -0.25, 3] }"#;

/// All readers on the same bytes; refusals must have words.
fn read_with_all(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let refusals = [
        read_scene(&text, "f").err().map(|error| error.to_string()),
        read_truth_json(&text, "f")
            .err()
            .map(|error| error.to_string()),
        read_log(bytes, "f").err().map(|error| error.to_string()),
        read_estimate(bytes, "f")
            .err()
            .map(|error| error.to_string()),
        read_frames(bytes, "f").err().map(|error| error.to_string()),
        read_truth_csv(bytes, "f")
            .err()
            .map(|error| error.to_string()),
    ];
    assert!(
        refusals
            .iter()
            .flatten()
            .all(|message| message.starts_with("f:") && message.len() > 10),
        "{refusals:?}"
    );
}

/// A good file with a piece cut out and another piece put in.
fn damaged(good: &str, at: prop::sample::Index, cut: usize, insert: &[u8]) -> Vec<u8> {
    let start = at.index(good.len());
    let end = (start + cut).min(good.len());
    [&good.as_bytes()[..start], insert, &good.as_bytes()[end..]].concat()
}

proptest! {
    #[test]
    fn arbitrary_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read_with_all(&bytes);
    }

    #[test]
    fn arbitrary_text_of_the_formats_is_read_or_refused(text in "[a-z0-9_=\\[\\]{}.,:\"'# \r\n\u{feff}µ-]{0,200}") {
        read_with_all(text.as_bytes());
    }

    #[test]
    fn damaged_files_are_read_or_refused(
        which in 0..3_usize,
        at in any::<prop::sample::Index>(),
        cut in 0..30_usize,
        insert in prop_oneof![prop::collection::vec(any::<u8>(), 0..5), "[0-9a-z.,\\[\\]{}\"\n=-]{0,8}".prop_map(String::into_bytes)],
    ) {
        read_with_all(&damaged([SCENE, LOG, JSON][which], at, cut, &insert));
    }
}
