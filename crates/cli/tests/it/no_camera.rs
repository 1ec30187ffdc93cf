//! A build without the camera chain says how to get it.

use crate::common::{stickslip, succeeds};

#[test]
fn commands_of_the_camera_chain_without_it_say_how_to_get_it() {
    for words in [
        &["track"][..],
        &["track", "frames", "--rate", "30", "--help"],
        &["print", "tags.svg", "--tags", "0"],
        &["calibrate", "board"],
        &["render", "folder"],
        &[
            "reproduce",
            "--seeds",
            "1",
            "--particles",
            "2",
            "--from-frames",
        ],
    ] {
        let run = stickslip().args(words).output().unwrap();
        let told = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(2), "{words:?}: {told}");
        assert!(run.stdout.is_empty(), "{words:?}");
        assert!(
            told.contains("cargo run --release --features camera --")
                && told.contains("cargo install --path crates/cli --features camera"),
            "{words:?}: {told}"
        );
    }
}

#[test]
fn help_lists_commands_of_the_camera_chain_and_how_to_get_them() {
    let help = succeeds(stickslip().arg("--help")).stdout;
    let help = String::from_utf8(help).unwrap();
    for line in [
        "Track the tags of object and pusher",
        "print, calibrate, track and render need the feature `camera`",
        "cargo install --path crates/cli --features camera",
    ] {
        assert!(help.contains(line), "{line} is not in\n{help}");
    }
}
