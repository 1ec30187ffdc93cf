//! Calibration from rendered frames, against the truth they were rendered from.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::{BOARD, BOARD_THICKNESS, CALIBRATION, true_camera};
use image::GrayImage;
use stickslip_vision::{
    Board, BoardOnTable, BoardRecording, Calibration, CalibrationError, CalibrationFrame, Lens,
    calibrate, search_board,
};

/// Two implementations of the same lens.
#[test]
fn lens_is_that_of_the_renderer() {
    let truth = true_camera();
    let lens = truth.lens();
    let same = Lens {
        size: lens.size,
        focal: lens.focal,
        centre: lens.centre,
        radial: lens.radial,
        tangential: lens.tangential,
    };
    for pixel in [[0.0, 0.0], [639.0, 479.0], [200.0, 400.0], [320.0, 240.0]] {
        let direction = lens.direction(pixel).unwrap();
        let ideal = same.undistort(pixel).unwrap();
        let expected = [0, 1].map(|k| lens.focal[k] * direction[k] + lens.centre[k]);
        assert!(
            (ideal[0] - expected[0]).abs() < 1e-9 && (ideal[1] - expected[1]).abs() < 1e-9,
            "{ideal:?} {expected:?}"
        );
        let [u, v] = same.distort(expected);
        assert!((u - pixel[0]).abs() < 1e-9 && (v - pixel[1]).abs() < 1e-9);
    }
}

/// Every point over the plate, to 40 mm above it, is projected to where it is seen.
#[test]
fn calibrate_finds_the_camera() {
    let Calibration {
        camera,
        rms,
        frames,
        tags,
        left_out,
        ..
    } = &*CALIBRATION;
    assert!(
        *rms < 0.03 && *frames == 12 && *tags > 300 && *left_out < 10,
        "{rms} {frames} {tags} {left_out}"
    );
    for x in [-0.10, 0.02, 0.14] {
        for y in [-0.09, 0.0, 0.09] {
            for z in [0.0, BOARD_THICKNESS, 0.02, 0.04] {
                let (found, truth) = (
                    camera.project([x, y, z]).unwrap(),
                    true_camera().project([x, y, z]),
                );
                let off = (found[0] - truth[0]).hypot(found[1] - truth[1]);
                // a pixel is half a millimetre
                assert!(off < 0.03, "({x}, {y}, {z}): {off} px");
            }
        }
    }
    let off = [0, 1, 2].map(|k| (camera.centre()[k] - true_camera().centre()[k]).abs());
    assert!(off.iter().all(|off| *off < 1e-3), "{off:?}");
}

/// Why a calibration from some frames of the recording is refused.
fn refusal(frames: &[CalibrationFrame], board: &BoardOnTable) -> CalibrationError {
    let recording = BoardRecording {
        frames: frames.to_vec(),
        size: BOARD.0.size,
    };
    calibrate(&recording, board, 0).unwrap_err()
}

fn without_tags(frame: &CalibrationFrame) -> CalibrationFrame {
    CalibrationFrame {
        tags: Vec::new(),
        ..frame.clone()
    }
}

#[test]
fn calibrate_says_what_the_frames_lack() {
    let (BoardRecording { frames, .. }, board) = &*BOARD;
    let none: Vec<CalibrationFrame> = frames.iter().map(without_tags).collect();
    let no_tag = CalibrationError::NoTag { frames: 12 };
    assert_eq!(refusal(&none, board), no_tag);

    let mut no_flat = frames.clone();
    no_flat[0] = without_tags(&frames[0]);
    let flat_frame = CalibrationError::FlatFrame {
        name: "0.png".to_owned(),
        found: 0,
    };
    assert_eq!(refusal(&no_flat, board), flat_frame);

    let too_few = CalibrationError::TooFewFrames {
        usable: 3,
        frames: 3,
    };
    assert_eq!(refusal(&frames[..3], board), too_few);

    let flat_only = refusal(&vec![frames[0].clone(); 6], board);
    let no_tilt = matches!(flat_only, CalibrationError::NoTilt { .. });
    assert!(no_tilt, "{flat_only}");

    // copies of tilted frames look like many measurements
    let few = [0, 5, 7].map(|k| vec![frames[k].clone(); 4]).concat();
    let same_views = CalibrationError::SameViews {
        distinct: 3,
        frames: 12,
    };
    assert_eq!(refusal(&few, board), same_views);
}

#[test]
fn calibrate_says_what_is_wrong_with_the_board() {
    let (BoardRecording { frames, .. }, on_table) = &*BOARD;
    let text = |board: Board| {
        let board = BoardOnTable { board, ..*on_table };
        refusal(frames, &board).to_string()
    };
    let other = text(Board {
        first_tag: 300,
        ..on_table.board
    });
    assert!(
        other.contains("on the board, which has 300 to 334; found: 100, 101,")
            && other.contains("Correct first_tag"),
        "{other}"
    );
    let stretched = text(Board {
        gap: 0.012,
        ..on_table.board
    });
    assert!(
        stretched.contains("px is good. Measure tag_size and gap"),
        "{stretched}"
    );
}

#[test]
fn search_board_refuses_frames_of_several_sizes() {
    let load = |index: usize| {
        Ok::<_, CalibrationError>((
            format!("{index}.png"),
            GrayImage::new(64, 48 + index as u32 / 2),
        ))
    };
    let text = search_board(3, load).unwrap_err().to_string();
    assert!(
        text.contains("2.png: the image has 64 x 49 pixels, 0.png has 64 x 48")
            && text.contains("Take the odd ones out"),
        "{text}"
    );
}
