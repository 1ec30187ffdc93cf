//! Tables: logs, estimates, truths, lists of frames.

#![no_main]

use libfuzzer_sys::fuzz_target;
use stickslip_formats::{read_estimate, read_frames, read_log, read_truth_csv, write_log};

fuzz_target!(|bytes: &[u8]| {
    if let Ok((log, _)) = read_log(bytes, "f") {
        // what was read is written and read again
        let mut text = Vec::new();
        write_log(&mut text, &log).expect("memory takes everything");
        assert_eq!(read_log(&text[..], "f").expect("our own").0, log);
    }
    let _ = read_estimate(bytes, "f");
    let _ = read_truth_csv(bytes, "f");
    let _ = read_frames(bytes, "f");
});
